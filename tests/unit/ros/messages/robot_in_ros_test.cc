#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "ros/messages/convert.h"
#include "ros/messages/names.h"
#include "ros/messages/robot_frames.h"
#include "tests/support/gripper_world.h"
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

// Joints in ROS: their names, the frames that they move, and the URDF with both.

using testing::HasSubstr;

void ExpectNear(const Pose& a, const Pose& b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
  EXPECT_NEAR(a.heading, b.heading, 1e-12);
}

// A robot with a lift, two fingers, an arm that turns on the lift, and a scanner at the end of the arm.
class RobotFramesTest : public testing::Test {
 protected:
  RobotFramesTest() : parts_(world_.AddGripperRobot({1.0, 2.0, 0.0, 0.5})) {
    const ModelId arm = world_.AddModel(test::Square(0.1), {0.0, 0.1}, {0.1, 0.0, 0.2, 0.25}, parts_.carriage);
    world_.AddJoint(parts_.robot, arm, {0.0, 0.0}, 1.0, {-1.0, 1.0});
    world_.world.joints.back().type = JointType::kRevolute;
    mount_ = world_.AddModel(std::vector<Block>(), {0.0, 0.05, 0.1, 0.0}, arm);
    SensorDescription ranger{.name = "ranger:0", .model = mount_};
    RaySensors(ranger) = {Fan(1.0, 5)};
    RaySensors(ranger)[0].X_MS = {0.02, 0.0, 0.0, -0.25};
    world_.world.robots[0].sensors = {ranger};
    const char* names[] = {"lift", "lift.left", "lift.right", "arm"};
    for (std::size_t i = 0; i < 4; ++i) world_.world.joints[i].name = names[i];
  }

  test::GripperWorld world_;
  test::GripperRobot parts_;
  ModelId mount_;
};

TEST_F(RobotFramesTest, ATreeOfJointsLeadsToEverySensor) {
  const Scene scene(world_.world);
  const RobotFrames frames = RobotFramesOf(scene, parts_.robot, FramesOf("r", true));
  std::map<std::string, std::string> parents;
  for (const MovingFrame& frame : frames.moving) EXPECT_TRUE(parents.emplace(frame.frame, frame.parent).second);
  for (const FixedFrame& frame : frames.fixed) EXPECT_TRUE(parents.emplace(frame.frame, frame.parent).second);
  EXPECT_EQ(parents, (std::map<std::string, std::string>{{"r/lift_link", "r/base_link"},
                                                         {"r/lift_left_link", "r/lift_link"},
                                                         {"r/lift_right_link", "r/lift_link"},
                                                         {"r/arm_link", "r/lift_link"},
                                                         {"r/scan", "r/arm_link"}}));
}

TEST_F(RobotFramesTest, HaveThePosesOfLinksAndSensors) {
  const Scene scene(world_.world);
  WorldState state = PlacedState(world_.world);
  const double positions[] = {0.75, 0.05, 0.125, -0.5};
  for (std::size_t i = 0; i < 4; ++i) state.joints[i].position = positions[i];
  const std::vector<Pose> X_WM = ModelPoses(world_.world, state);

  const RobotFrames frames = RobotFramesOf(scene, parts_.robot, FramesOf("r", true));
  std::map<std::string, Pose> X_WF = {{"r/base_link", state.robots[0].X_WR}};
  for (const MovingFrame& frame : frames.moving) {
    const Pose X = X_PF(frame, world_.world, positions[frame.joint.index()]);
    X_WF[frame.frame] = X_WF.at(frame.parent) * X;
    SCOPED_TRACE(frame.frame);
    ExpectNear(X_WF[frame.frame], X_WM[world_.world.joint(frame.joint).model.index()]);
  }
  const FixedFrame& scan = frames.fixed.at(0);
  ExpectNear(X_WF.at(scan.parent) * scan.X_PF,
             X_WM[mount_.index()] * RaySensors(world_.world.robots[0].sensors[0])[0].X_MS);
}

TEST_F(RobotFramesTest, TheUrdfHasTheSameFramesWithLimitsAndAxes) {
  const std::string urdf = MakeRobotDescription(Scene(world_.world), parts_.robot, "r", FramesOf("r", true));
  EXPECT_THAT(urdf, HasSubstr(R"(<joint name="lift" type="prismatic"><parent link="r/base_link"/>)"
                              R"(<child link="r/lift_link"/><origin xyz="0.25 0 0" rpy="0 0 0"/><axis xyz="0 0 1"/>)"
                              R"(<limit lower="0" upper="1" velocity="10" effort="0"/></joint>)"));
  EXPECT_THAT(urdf,
              HasSubstr(R"(<joint name="lift_left" type="prismatic"><parent link="r/lift_link"/>)"
                        R"(<child link="r/lift_left_link"/><origin xyz="0 0 0" rpy="0 0 0"/><axis xyz="0 -1 0"/>)"));
  EXPECT_THAT(urdf, HasSubstr(R"(<joint name="arm" type="revolute"><parent link="r/lift_link"/>)"
                              R"(<child link="r/arm_link"/><origin xyz="0.1 0 0.2" rpy="0 0 0.25"/>)"
                              R"(<axis xyz="0 0 1"/><limit lower="-1" upper="1")"));
  EXPECT_THAT(urdf, HasSubstr(R"(<parent link="r/arm_link"/><child link="r/scan"/>)"));
  // The box of the arm is drawn on the arm.
  const std::size_t arm = urdf.find(R"(<link name="r/arm_link">)");
  ASSERT_NE(arm, std::string::npos);
  EXPECT_EQ(urdf.find(R"(<origin xyz="0 0 0.05" rpy="0 0 0"/><geometry><box size="0.1 0.1 0.1"/>)", arm),
            urdf.find("<origin", arm));
}

// The frames of a URDF: the first is the base, the others hang on what moves them, and the scanner measures in one.
TEST_F(RobotFramesTest, KeepTheNamesOfTheRobotsFile) {
  RobotDescription& robot = world_.world.robots[0];
  const ModelId arm = world_.world.joints.back().model;
  robot.frames = {{"base_footprint", robot.root, {}, 0.0, 0.0},
                  {"lift_link", robot.root, {0.1, 0.2, 0.3, 0.5}, 0.0, 0.0},
                  {"laser", arm, {0.0, 0.0, 0.1, -0.5 * kPi}, -0.5 * kPi, 0.0}};
  robot.sensors[0].frame = "laser";
  const Scene scene(world_.world);
  EXPECT_EQ(BaseFrameOf(robot), "base_footprint");
  EXPECT_EQ(FindRobotInRos(world_.world, parts_.robot, 7, {}).frames.base,
            RobotNames(world_.world)[0] + "/base_footprint");
  EXPECT_EQ(SensorTopicsOf(robot).lasers[0].frame, "laser");
  EXPECT_EQ(SensorTopicsOf(robot).lasers[0].topic, "scan");
  const RobotFrames frames = RobotFramesOf(scene, parts_.robot, FramesOf("r", true, BaseFrameOf(robot)));
  ASSERT_EQ(frames.fixed.size(), 2u) << "the scanner has no frame of its own";
  EXPECT_EQ(frames.fixed[0].parent, "r/base_footprint");
  EXPECT_EQ(frames.fixed[0].frame, "r/lift_link");
  EXPECT_EQ(frames.moving[0].frame, "r/lift_link_1") << "the name is taken";
  EXPECT_EQ(frames.fixed[1].parent, "r/arm_link");
  dds::WireArena arena;
  // An optical frame: z ahead, x to the right.
  const auto rotation = MakeTransform({}, frames.fixed[1], arena).transform.rotation;
  EXPECT_NEAR(rotation.x, -0.5, 1e-12);
  EXPECT_NEAR(rotation.y, 0.5, 1e-12);
  EXPECT_NEAR(rotation.z, -0.5, 1e-12);
  EXPECT_NEAR(rotation.w, 0.5, 1e-12);
  const std::string urdf = MakeRobotDescription(scene, parts_.robot, "r", FramesOf("r", true, "base_footprint"));
  EXPECT_THAT(urdf, HasSubstr(R"(<link name="r/base_footprint">)"));
  EXPECT_THAT(urdf, HasSubstr(R"(<child link="r/laser"/><origin xyz="0 0 0.1" rpy="-1.5708 0 -1.5708"/>)"));
}

TEST_F(RobotFramesTest, MarkersAreInTheFrameOfTheirLink) {
  const Scene scene(world_.world);
  const RobotFrames frames = RobotFramesOf(scene, parts_.robot, FramesOf("r", true));
  dds::WireArena arena;
  std::multiset<std::string> drawn;
  const MarkerArray message = MakeBlockMarkers(scene, {frames.links}, arena);
  for (const Marker& marker : dds::Elements(message.markers)) drawn.insert(marker.header.frame_id);
  EXPECT_EQ(drawn, (std::multiset<std::string>{"r/base_link", "r/lift_left_link", "r/lift_right_link", "r/arm_link"}));
}

TEST(JointNamesOf, MakesNamesAndFramesUnique) {
  test::GripperWorld world;
  const test::GripperRobot parts = world.AddGripperRobot({});
  world.world.joints[0].name = "a.b";
  world.world.joints[1].name = "a_b";
  world.world.joints[2].name = "scan_mount";
  SensorDescription ranger{.name = "a_b_link", .model = parts.root};
  RaySensors(ranger) = {Fan(1.0, 5)};
  world.world.robots[0].sensors = {ranger, ranger};
  world.world.robots[0].sensors[1].name = "ranger:1";
  std::set<std::string> names = {"scan_mount"};
  std::set<std::string> frames = {"a_b_link", "scan"};
  for (const JointName& joint : JointNamesOf(world.world, parts.robot)) {
    EXPECT_TRUE(names.insert(joint.name).second) << joint.name;
    EXPECT_TRUE(frames.insert(joint.frame).second) << joint.frame;
  }
  EXPECT_EQ(names.size(), 4u);
}

LocalizationDescription Odometry() {
  LocalizationDescription localization{
      .type = LocalizationType::kOdometry, .error_x = 0.1, .error_y = 0.2, .error_heading = 0.05};
  return localization;
}

TEST(OdometryError, IsZeroForGps) {
  LocalizationDescription gps = Odometry();
  gps.type = LocalizationType::kGps;
  OdometryError error(gps);
  error.AddMotion({1.0, 1.0, 1.0}, 10.0);
  EXPECT_EQ(error.covariance().x, 0.0);
  EXPECT_EQ(error.covariance().wz, 0.0);
}

TEST(OdometryError, GrowsWithThePathInBothDirections) {
  OdometryError error(Odometry());
  error.AddMotion({2.0, 0.0, 0.0}, 1.0);
  EXPECT_NEAR(error.covariance().x, 0.04, 1e-12);
  EXPECT_EQ(error.covariance().y, 0.0);
  EXPECT_NEAR(error.covariance().vx, 0.04, 1e-12);
  error.AddMotion({-2.0, 0.0, 0.0}, 1.0);
  EXPECT_NEAR(error.covariance().x, 0.16, 1e-12);
  error.AddMotion({0.0, 0.0, 2.0}, 1.0);
  EXPECT_NEAR(error.covariance().heading, 0.01, 1e-12);
  EXPECT_EQ(error.covariance().vx, 0.0);
}

TEST(OdometryError, OfTheHeadingDisplacesThePosition) {
  OdometryError error(Odometry());
  error.AddMotion({1.0, 0.0, 1.0}, 2.0);
  EXPECT_NEAR(error.covariance().y, 0.04, 1e-12);
}

}  // namespace
}  // namespace troupe::ros
