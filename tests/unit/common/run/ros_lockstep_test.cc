#include "common/run/ros_lockstep.h"

#include <gtest/gtest.h>

#include <string>

namespace troupe {
namespace {

TEST(RosLockstepNames, AreTopicsOrNodesAsRosHasThem) {
  for (const char* name : {"/cmd_vel", "/anna/cmd_vel", "~/cmd_vel", "~/a/b_2", "driver", "node0", "_x", "Mapper"}) {
    EXPECT_TRUE(CheckRosLockstepName(name).ok()) << name;
  }
  for (const char* name :
       {"",          "/",          "~", "~/",  "~cmd_vel", "~/~/cmd_vel", "anna/cmd_vel", "/anna//cmd_vel", "/cmd_vel/",
        "//cmd_vel", "/0/cmd_vel", "0", "a b", " driver",  "/a b",        "driver\n",     "dr\xc3\xa4ger",  "a-b",
        "/a.b",      "{node}"}) {
    const Status status = CheckRosLockstepName(name);
    ASSERT_FALSE(status.ok()) << name;
    EXPECT_TRUE(status.error().message.starts_with("found '")) << status.error().message;
  }
  EXPECT_TRUE(CheckRosLockstepName(std::string(200, 'a')).ok());
  const Status too_long = CheckRosLockstepName("/" + std::string(1'000'000, 'a'));
  ASSERT_FALSE(too_long.ok());
  EXPECT_LT(too_long.error().message.size(), 400U);
}

}  // namespace
}  // namespace troupe
