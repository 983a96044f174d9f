#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros/messages/names.h"
#include "tests/support/small_world.h"

namespace troupe::ros {
namespace {

WorldDescription ThreeRobots() {
  SmallWorld world;
  for (const char* name : {"a", "b", "c"}) world.AddRobot(name, {});
  return world.world();
}

constexpr RosNames kPlain = {.plain = true};

TEST(RobotInRos, HasItsNameInTheDomainOfTheRun) {
  const RobotInRos robot = FindRobotInRos(ThreeRobots(), RobotId(1), 7, {});
  EXPECT_EQ(robot.domain, 7u);
  EXPECT_FALSE(robot.alone);
  EXPECT_EQ(robot.node_namespace, "/b");
  EXPECT_EQ(robot.frames.base, "b/base_link");
}

TEST(RobotInRos, HasPlainNamesInADomainOfItsOwn) {
  WorldDescription world = ThreeRobots();
  world.robots[1].ros.domain = 9;
  const RobotInRos robot = FindRobotInRos(world, RobotId(1), 7, {});
  EXPECT_EQ(robot.domain, 9u);
  EXPECT_TRUE(robot.alone);
  EXPECT_EQ(robot.node_namespace, "/");
  EXPECT_EQ(robot.frames.base, "base_link");
  EXPECT_FALSE(FindRobotInRos(world, RobotId(1), 9, {}).alone) << "the run's domain";
  EXPECT_EQ(FindRobotInRos(world, RobotId(1), 9, {}).node_namespace, "/");
}

TEST(RobotInRos, OnlyTheFirstOfADomainHasPlainNames) {
  WorldDescription world = ThreeRobots();
  world.robots[0].ros.domain = 9;
  EXPECT_EQ(FindRobotInRos(world, RobotId(1), 7, kPlain).node_namespace, "/");
  EXPECT_EQ(FindRobotInRos(world, RobotId(2), 7, kPlain).node_namespace, "/c");
}

TEST(RobotInRos, HasTheNamespaceOfItsDescriptionIfItIsOne) {
  WorldDescription world = ThreeRobots();
  world.robots[0].ros.name_space = "/fleet/a";
  EXPECT_EQ(FindRobotInRos(world, RobotId(0), 7, {}).node_namespace, "/fleet/a");
  EXPECT_EQ(FindRobotInRos(world, RobotId(0), 7, {}).frames.odom, "fleet/a/odom");
  world.robots[0].ros.name_space = "//x";
  EXPECT_EQ(FindRobotInRos(world, RobotId(0), 7, {}).node_namespace, "/a");
}

TEST(RobotInRos, ARemovedRobotIsNowhere) {
  WorldDescription world = ThreeRobots();
  world.models[world.robots[0].root.index()].removed = true;
  EXPECT_EQ(FindRobotInRos(world, RobotId(1), 7, kPlain).node_namespace, "/");
  const auto found = FindRobotsInRos(world, 7, {});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].second.node_namespace, "/b");
  EXPECT_EQ(found[1].second.node_namespace, "/c");
  world.robots[0].ros.domain = 42;
  EXPECT_TRUE(CheckDomains(world, 7, {}, 42).ok());
}

TEST(NoticesOfNames, NameEachRobotWithOtherTopicsThanItsName) {
  SmallWorld made;
  for (const char* name : {"0", "a-b", "a_b", "anna"}) made.AddRobot(name, {});
  WorldDescription world = made.world();
  EXPECT_THAT(
      NoticesOfNames(world, 7, {}),
      testing::ElementsAre("the topics of robot '0' are below /n0: names in ROS have letters, digits and single "
                           "underscores",
                           "the topics of robot 'a-b' are below /a_b_1: another robot has its name as ROS "
                           "would spell it"));
  world.robots[0].ros.domain = 9;  // where it has plain names
  world.robots[1].ros.name_space = "/fleet/a";
  EXPECT_THAT(NoticesOfNames(world, 7, {}), testing::IsEmpty());
}

TEST(NoticesOfNames, AreFewInAFleet) {
  SmallWorld world;
  for (int i = 0; i < 30; ++i) world.AddRobot("position:" + std::to_string(i), {});
  const std::vector<std::string> notices = NoticesOfNames(world.world(), 7, {});
  ASSERT_EQ(notices.size(), 11u);
  EXPECT_EQ(notices.back(), "20 more robots have other names in ROS than in the world");
}

TEST(IsNamespace, FollowsTheRulesOfRos) {
  for (const char* good : {"/a", "/fleet/anna", "/a_b/c1"}) EXPECT_TRUE(IsNamespace(good)) << good;
  for (const char* bad : {"", "/", "a", "/a/", "//a", "/1", "/a b", "/a__b", "/a//b", "/\xc3\xa4"}) {
    EXPECT_FALSE(IsNamespace(bad)) << bad;
  }
}

TEST(CheckDomains, RefusesTheDomainOfTheSimulation) {
  WorldDescription world = ThreeRobots();
  EXPECT_TRUE(CheckDomains(world, 7, {}, 42).ok());
  EXPECT_THAT(CheckDomains(world, 42, {}, 42).error().message, testing::HasSubstr("42 as the domain of the run"));
  world.robots[2].ros.domain = 42;
  EXPECT_THAT(CheckDomains(world, 7, {}, 42).error().message,
              testing::HasSubstr("found the ROS domain 42 for robot 'c', which is the domain of the simulation"));
  EXPECT_TRUE(CheckDomains(world, 7, {}, std::nullopt).ok());
}

TEST(CheckDomains, RefusesPlainNamesForSeveralRobotsOfADomain) {
  WorldDescription world = ThreeRobots();
  EXPECT_THAT(CheckDomains(world, 7, kPlain, 42).error().message,
              testing::HasSubstr("found --ros-names plain for 3 robots in one ROS domain"));
  world.robots[0].ros.domain = 8;
  world.robots[1].ros.domain = 9;
  EXPECT_TRUE(CheckDomains(world, 7, kPlain, 42).ok());
}

}  // namespace
}  // namespace troupe::ros
