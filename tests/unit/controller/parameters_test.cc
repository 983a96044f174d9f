#include "troupe/parameters.h"

#include <gtest/gtest.h>

#include "tests/support/message_of.h"

namespace troupe {
namespace {

TEST(Parameters, AreReadByKey) {
  Parameters parameters("p", R"({"speed": 0.4, "loud": true, "wall": "left", "turn": "right"})");
  EXPECT_EQ(parameters.ReadNumber("speed", {0.0, 1.0}), 0.4);
  EXPECT_EQ(parameters.ReadNumber("distance", {0.0, 1.0}), std::nullopt);
  EXPECT_EQ(parameters.ReadBool("loud"), true);
  EXPECT_EQ(parameters.ReadText("wall"), "left");
  EXPECT_EQ(parameters.ReadNumberOrName("turn", {-1.0, 1.0}, {{"left", 1.0}, {"right", -1.0}}), -1.0);
  EXPECT_EQ(MessageOf(parameters.Finish()), "");
}

TEST(Parameters, OfTheWrongKindAreErrorsAndHaveNoValue) {
  Parameters number("p", R"({"x": 2})");
  EXPECT_EQ(number.ReadNumber("x", {0.0, 1.0}), std::nullopt);
  EXPECT_EQ(MessageOf(number.status()), "p: 'x' is 2, expected a number between 0 and 1");
  Parameters flag("p", R"({"x": 1})");
  EXPECT_EQ(flag.ReadBool("x"), std::nullopt);
  EXPECT_EQ(MessageOf(flag.status()), "p: 'x' is 1, expected true or false");
  Parameters text("p", R"({"x": {}})");
  EXPECT_EQ(text.ReadText("x"), std::nullopt);
  EXPECT_EQ(MessageOf(text.status()), "p: 'x' is an object, expected a text");
}

TEST(Parameters, KeepTheFirstErrorAndNameUnknownKeys) {
  Parameters first("p", "[]");
  first.Fail("another");
  EXPECT_EQ(MessageOf(first.Finish()), "p: found a list as parameters, expected a JSON object");
  Parameters unknown("p", R"({"sped": 1})");
  EXPECT_EQ(unknown.ReadNumber("speed", {0.0, 1.0}), std::nullopt);
  EXPECT_EQ(MessageOf(unknown.status()), "");
  EXPECT_EQ(MessageOf(unknown.Finish()),
            "p: unknown parameter \"sped\", expected one of: speed; did you mean 'speed'?");
}

}  // namespace
}  // namespace troupe
