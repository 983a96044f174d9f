#include "ros/messages/robot_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/small_world.h"

namespace troupe::ros {
namespace {

RobotList ListOfThree() {
  SmallWorld world;
  for (const char* name : {"a", "b", "c"}) world.AddRobot(name, {});
  WorldDescription description = world.world();
  description.robots[1].ros.domain = 9;
  RosOptions options;
  options.domain = 7;
  return RobotListOf(description, options);
}

TEST(RobotList, HasNamespacesOfTheRunAndOtherDomains) {
  EXPECT_THAT(ListOfThree().namespaces, testing::ElementsAre("/a", "/c"));
  EXPECT_THAT(ListOfThree().domains, testing::ElementsAre(9u));
}

TEST(RobotList, KnowsTheServicesOfItsRobots) {
  const RobotList list = ListOfThree();
  EXPECT_TRUE(list.HasService("a/robot/list_parameters"));
  for (const char* other : {"ab/robot/list_parameters", "b/robot/list_parameters", "a", "reset"}) {
    EXPECT_FALSE(list.HasService(other)) << other;
  }
  EXPECT_TRUE((RobotList{{"/"}, {}}).HasService("robot/list_parameters"));
}

TEST(RobotList, IsTheSameAfterItsText) {
  EXPECT_EQ(ParseRobotList(ToText(ListOfThree())), ListOfThree());
  EXPECT_EQ(ParseRobotList(ToText({})), RobotList());
}

TEST(RobotList, OtherTextIsNone) {
  for (const char* text : {"", "{}", "[]", R"({"namespaces": ["/a"]})", R"({"namespaces": [1], "domains": []})",
                           R"({"namespaces": [], "domains": [231]})", R"({"namespaces": [], "domains": [-1]})",
                           R"({"namespaces": [], "domains": ["1"]})"}) {
    EXPECT_EQ(ParseRobotList(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace troupe::ros
