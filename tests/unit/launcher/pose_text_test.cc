#include <gtest/gtest.h>

#include <numbers>

#include "launcher/commands/commands.h"
#include "tests/support/values.h"

namespace troupe {
namespace {

TEST(PoseText, HasThreeOrFourNumbersAsInScenarios) {
  const PoseText three = test::ValueOf(ParsePoseText("1.5,-2,90"));
  EXPECT_EQ(three.X_WE, (Pose{1.5, -2.0, 0.0, std::numbers::pi / 2.0}));
  EXPECT_FALSE(three.has_height);
  const PoseText four = test::ValueOf(ParsePoseText("-1,2,0.5,0"));
  EXPECT_EQ(four.X_WE, (Pose{-1.0, 2.0, 0.5, 0.0}));
  EXPECT_TRUE(four.has_height);
}

TEST(PoseText, AnyOtherTextIsAnError) {
  for (const char* text :
       {"", "1", "1,2", "1,2,3,4,5", "1,2,x", "1,,2", "1,2,3,", ",1,2,3", "1 2 3", "1,2,nan", "1,2,1e999", "1, 2, 3"}) {
    const Result<PoseText> read = ParsePoseText(text);
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_EQ(read.error().message,
              "found '" + std::string(text) + "', expected X,Y,HEADING or X,Y,Z,HEADING, in metres and degrees");
  }
}

}  // namespace
}  // namespace troupe
