// Joints in ROS: their names, the frames that they move, and the URDF with both.
#include "ros/messages/robot_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "ros/messages/convert.h"
#include "tests/support/gripper_world.h"
#include "tests/support/small_world.h"

namespace troupe::ros {
namespace {

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

}  // namespace
}  // namespace troupe::ros
