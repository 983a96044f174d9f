// The transforms of robots' frames in ROS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "ros/connection/ros_network.h"
#include "tests/support/dds_domain.h"
#include "tests/support/ros_gateway_fixture.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/wire.h"

namespace troupe {
namespace {

using RobotTransformsTest = test::RosGatewayFixture;
using test::Eventually;
using test::ParentsOf;
using test::TwoGrippers;
using testing::ElementsAre;

TEST_F(RobotTransformsTest, ConnectsTheTreeOfFrames) {
  MakeReplica(options_);
  auto moving = Reader<ros::TfMessage>("/tf");
  auto fixed = Reader<ros::TfMessage>("/tf_static", true);
  std::map<std::string, std::string> parents;
  TickUntilReceived(fixed, [&](const ros::TfMessage& message) { parents = ParentsOf(message); });
  EXPECT_EQ(parents.size(), 8u);
  TickUntilReceived(moving, [&](const ros::TfMessage& message) {
    for (const auto& [child, parent] : ParentsOf(message)) EXPECT_TRUE(parents.emplace(child, parent).second);
  });
  EXPECT_EQ(parents.size(), 10u);
  for (auto [child, parent] : parents) {
    int steps = 0;
    while (parent != "map" && ++steps < 10) parent = parents[parent];
    EXPECT_EQ(parent, "map") << child;
  }
  EXPECT_EQ(parents["a/scan"], "a/base_link");
  EXPECT_EQ(parents["b/base_link"], "b/odom");
}

TEST_F(RobotTransformsTest, MovesTheFramesOfJointsWithTheSensorsOnThem) {
  MakeReplica(options_, TwoGrippers().world);
  state_.joints[3].position = 0.25;  // of b
  state_.joints[4].position = 0.05;
  state_.joints[4].velocity = -0.5;
  auto moving = Reader<ros::TfMessage>("/tf");
  auto fixed = Reader<ros::TfMessage>("/tf_static", true);
  auto joints = Reader<ros::JointStateMessage>("/b/joint_states");
  std::map<std::string, std::string> parents;
  TickUntilReceived(moving, [&](const ros::TfMessage& message) {
    parents = ParentsOf(message);
    for (const ros::TransformStamped& transform : dds::Elements(message.transforms)) {
      const auto& shift = transform.transform.translation;
      if (dds::Text(transform.child_frame_id) == "b/gripper_lift_link") {
        EXPECT_EQ(shift.x, 0.25);
        EXPECT_EQ(shift.z, 0.25);
      } else if (dds::Text(transform.child_frame_id) == "b/gripper_left_link") {
        EXPECT_EQ(shift.y, -0.05);
      }
    }
  });
  EXPECT_EQ(parents["b/gripper_left_link"], "b/gripper_lift_link");
  EXPECT_EQ(parents["b/gripper_lift_link"], "b/base_link");
  EXPECT_EQ(parents.size(), 8u);
  TickUntilReceived(fixed, [](const ros::TfMessage& message) {
    EXPECT_EQ(ParentsOf(message)["a/scan"], "a/gripper_lift_link");
    EXPECT_EQ(ParentsOf(message).size(), 4u) << "two scanners, and odom in map";
  });
  TickUntilReceived(joints, [](const ros::JointStateMessage& message) {
    EXPECT_THAT(dds::Strings(message.name), ElementsAre("gripper_lift", "gripper_left", "gripper_right"));
    EXPECT_THAT(dds::Elements(message.position), ElementsAre(0.25, 0.05, 0.0));
    EXPECT_THAT(dds::Elements(message.velocity), ElementsAre(0.0, -0.5, 0.0));
  });
}

TEST_F(RobotTransformsTest, PublishesTransformsPerRobotIfAsked) {
  options_.names.namespaced_tf = true;
  options_.robots.map_to_odom = false;
  MakeReplica(options_);
  auto moving = Reader<ros::TfMessage>("/b/tf");
  auto fixed = Reader<ros::TfMessage>("/b/tf_static", true);
  TickUntilReceived(moving, [](const ros::TfMessage& message) {
    EXPECT_EQ(ParentsOf(message), (std::map<std::string, std::string>{{"base_link", "odom"}}));
  });
  TickUntilReceived(fixed, [](const ros::TfMessage& message) {
    EXPECT_EQ(ParentsOf(message), (std::map<std::string, std::string>{{"base_footprint", "base_link"},
                                                                      {"scan", "base_link"},
                                                                      {"sonar_0", "base_link"},
                                                                      {"sonar_1", "base_link"}}));
  });
}

// A node that transforms a scan at its stamp would wait for a transform that arrives later.
TEST_F(RobotTransformsTest, WritesTheTransformsOfATickBeforeItsScans) {
  MakeReplica(options_);
  const auto stamp = [](const ros::Header& header) { return std::pair(header.stamp.sec, header.stamp.nanosec); };
  using WrittenAt = std::map<std::pair<std::int32_t, std::uint32_t>, dds_time_t>;
  WrittenAt transforms;
  WrittenAt scans;
  dds::Topic<ros::TfMessage> tf(participant_.participant(), "rt/tf");
  dds::Topic<ros::LaserScan> scan(participant_.participant(), "rt/a/scan");
  dds::DataReader<ros::TfMessage> tf_reader(participant_.subscriber(), tf, ros::ToDds(ros::Stream(100)));
  dds::DataReader<ros::LaserScan> scan_reader(participant_.subscriber(), scan, ros::ToDds(ros::Stream(100)));
  int compared = 0;
  ASSERT_TRUE(Eventually([&] {
    Tick();
    for (const auto sample : tf_reader.take()) {
      if (!sample.info().valid() || sample.data().transforms._length == 0) continue;
      transforms[stamp(sample.data().transforms._buffer[0].header)] = sample.info().source_timestamp();
    }
    for (const auto sample : scan_reader.take()) {
      if (sample.info().valid()) scans[stamp(sample.data().header)] = sample.info().source_timestamp();
    }
    compared = 0;
    for (const auto& [time, written] : scans) {
      const auto transform = transforms.find(time);
      if (transform == transforms.end()) continue;
      ++compared;
      EXPECT_LE(transform->second, written);
    }
    return compared >= 3;
  }));
}

TEST_F(RobotTransformsTest, LeavesTheTransformOfTheBaseToAnotherNodeIfAsked) {
  options_.robots.odom_to_base = false;
  MakeReplica(options_, TwoGrippers().world);
  auto moving = Reader<ros::TfMessage>("/tf");
  auto odom = Reader<ros::OdometryMessage>("/b/odom");
  std::map<std::string, std::string> parents;
  TickUntilReceived(moving, [&](const ros::TfMessage& message) { parents = ParentsOf(message); });
  EXPECT_FALSE(parents.contains("a/base_link"));
  EXPECT_FALSE(parents.contains("b/base_link"));
  EXPECT_TRUE(parents.contains("b/gripper_lift_link"));
  TickUntilReceived(
      odom, [](const ros::OdometryMessage& message) { EXPECT_EQ(dds::Text(message.child_frame_id), "b/base_link"); });
}

}  // namespace
}  // namespace troupe
