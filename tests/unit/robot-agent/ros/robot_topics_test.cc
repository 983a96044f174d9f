// What a robot publishes in ROS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ros/connection/ros_network.h"
#include "ros/messages/convert.h"
#include "tests/support/dds_domain.h"
#include "tests/support/ros_gateway_fixture.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/wire.h"

namespace troupe {
namespace {

using RobotTopicsTest = test::RosGatewayFixture;
using test::Eventually;
using test::TwoRobots;
using test::UserDataOf;

TEST_F(RobotTopicsTest, PublishesOdometryGroundTruthAndStall) {
  MakeReplica(options_);
  state_.robots[1].stalled = true;
  auto odom = Reader<ros::OdometryMessage>("/b/odom");
  auto truth = Reader<ros::OdometryMessage>("/b/ground_truth");
  auto stalled = Reader<ros::Bool>("/b/stalled");
  TickUntilReceived(odom, [](const ros::OdometryMessage& message) {
    EXPECT_STREQ(message.header.frame_id, "b/odom");
    EXPECT_STREQ(message.child_frame_id, "b/base_link");
    EXPECT_EQ(message.pose.pose.position.x, 1.0);
    EXPECT_EQ(message.pose.pose.position.y, 2.0);
    for (std::size_t i = 0; i < 36; i += 7) {
      EXPECT_GT(message.pose.covariance[i], 0.0) << i;
      EXPECT_GT(message.twist.covariance[i], 0.0) << i;
    }
  });
  TickUntilReceived(truth, [](const ros::OdometryMessage& message) {
    EXPECT_STREQ(message.header.frame_id, "map");
    EXPECT_EQ(message.pose.pose.position.x, 3.0);
  });
  TickUntilReceived(stalled, [](const ros::Bool& message) { EXPECT_TRUE(message.data); });
}

// tf2 and filters take a repeated stamp for an error. The scan may have changed by the edit.
TEST_F(RobotTopicsTest, APauseAfterATickRepeatsNoOdometryOfARobotThatStays) {
  MakeReplica({.network = test::TestRosNetwork()});
  auto odom = Reader<ros::OdometryMessage>("/a/odom");
  auto transforms = Reader<ros::TfMessage>("/tf");
  std::vector<ros::Time> stamps;
  std::vector<ros::Time> of_transforms;
  const auto drain = [&] {
    odom.Drain([&](const auto& message) { stamps.push_back(message.header.stamp); });
    transforms.Drain([&](const auto& message) {
      for (const auto& transform : dds::Elements(message.transforms)) {
        if (std::strcmp(transform.child_frame_id, "a/base_link") == 0) of_transforms.push_back(transform.header.stamp);
      }
    });
  };
  EXPECT_TRUE(Eventually([&] {
    Tick();
    drain();
    return !stamps.empty() && !of_transforms.empty();
  }));
  for (int edit = 0; edit < 3; ++edit) {
    (void)replica_->Pause(state_);
    replica_->Publish(state_);
  }
  const ros::Time last = ros::ToTime(state_.tick + 1, replica_->scene()->world().interval_ns);
  ++state_.tick;
  Tick();
  const auto is_last = [&](const ros::Time& stamp) { return stamp.sec == last.sec && stamp.nanosec == last.nanosec; };
  EXPECT_TRUE(Eventually([&] {
    drain();
    return is_last(stamps.back()) && is_last(of_transforms.back());
  }));
  for (const auto& all : {stamps, of_transforms}) {
    std::set<std::pair<std::int32_t, std::uint32_t>> different;
    for (const ros::Time& stamp : all) different.emplace(stamp.sec, stamp.nanosec);
    EXPECT_EQ(different.size(), all.size());
  }
}

TEST_F(RobotTopicsTest, PublishesScansAndRanges) {
  MakeReplica(options_);
  auto scans = Reader<ros::LaserScan>("/a/scan");
  auto ranges = Reader<ros::RangeMessage>("/a/sonar");
  TickUntilReceived(scans, [](const ros::LaserScan& scan) {
    EXPECT_STREQ(scan.header.frame_id, "a/scan");
    ASSERT_EQ(scan.ranges._length, 5u);
    EXPECT_FLOAT_EQ(scan.ranges._buffer[2], 2.7F);  // from x = 0.1 to b's side at 2.8
    EXPECT_EQ(scan.ranges._buffer[0], std::numeric_limits<float>::infinity()) << "no hit";
  });
  std::vector<std::string> frames;
  ASSERT_TRUE(Eventually([&] {
    Tick();
    ranges.Drain([&](const ros::RangeMessage& range) {
      frames.emplace_back(range.header.frame_id);
      EXPECT_FLOAT_EQ(range.range, 2.8F);
    });
    return frames.size() >= 3;
  }));
  // The writer may have discovered the reader between the two sonars.
  if (frames[0] == "a/sonar_1") frames.erase(frames.begin());
  EXPECT_EQ(frames[0], "a/sonar_0");
  EXPECT_EQ(frames[1], "a/sonar_1");
}

TEST_F(RobotTopicsTest, PublishesCamerasCloudsAndTouches) {
  SmallWorld world;
  const RobotId robot = world.AddRobot("a", {});
  world.AddBox("wall", 0.3, 0.0, 0.2, 4.0, {0.0, 0.3});
  test::AddSensor(world.world(), robot, {0.0, 0.0, 0.2, 0.0},
                  CameraParameters{.width = 4, .height = 3, .range = {0.1, 8.0}});
  RaySensorDescription scanner = Fan(0.2, 3);
  scanner.elevations = {-0.1, 0.1};
  test::AddSensor(world.world(), robot, {0.0, 0.0, 0.2, 0.0}, RangerParameters{{scanner}});
  test::AddSensor(world.world(), robot, {}, ContactParameters{});
  MakeReplica(options_, world.world());
  auto images = Reader<ros::ImageMessage>("/a/camera/image_raw");
  auto depths = Reader<ros::ImageMessage>("/a/camera/depth/image_raw");
  auto optics = Reader<ros::CameraInfo>("/a/camera/camera_info");
  auto clouds = Reader<ros::PointCloud2>("/a/scan/points");
  auto contact = Reader<ros::Bool>("/a/contact");
  auto fixed = Reader<ros::TfMessage>("/tf_static", true);
  TickUntilReceived(images, [](const ros::ImageMessage& image) {
    EXPECT_STREQ(image.header.frame_id, "a/camera_optical");
    EXPECT_EQ(image.data._length, 36u);
  });
  TickUntilReceived(depths, [](const ros::ImageMessage& image) {
    ASSERT_EQ(image.data._length, 48u);
    float depth = 0.0F;
    std::memcpy(&depth, image.data._buffer + 4 * 5, sizeof depth);  // the middle row
    EXPECT_FLOAT_EQ(depth, 0.2F);
  });
  TickUntilReceived(optics, [](const ros::CameraInfo& info) { EXPECT_EQ(info.k[2], 2.0); });
  TickUntilReceived(clouds, [](const ros::PointCloud2& cloud) {
    EXPECT_STREQ(cloud.header.frame_id, "a/scan");
    EXPECT_EQ(cloud.width, 6u);
  });
  TickUntilReceived(contact, [](const ros::Bool& pressed) { EXPECT_TRUE(pressed.data); });
  TickUntilReceived(fixed, [](const ros::TfMessage& message) {
    for (const ros::TransformStamped& transform : dds::Elements(message.transforms)) {
      if (dds::Text(transform.child_frame_id) != "a/camera_optical") continue;
      EXPECT_STREQ(transform.header.frame_id, "a/camera");
      return;
    }
    ADD_FAILURE() << "no frame of images";
  });
}

TEST_F(RobotTopicsTest, SendsTheRangeOfHumbleToHumble) {
  options_.network.distribution = ros::Distribution::kHumble;
  MakeReplica(options_);
  auto ranges = Reader<ros::HumbleRangeMessage>("/a/sonar");
  TickUntilReceived(ranges, [](const ros::HumbleRangeMessage& range) { EXPECT_FLOAT_EQ(range.range, 2.8F); });
}

TEST_F(RobotTopicsTest, ARobotWithoutJointsHasNoJointStates) {
  MakeReplica(options_);
  auto joints = Reader<ros::JointStateMessage>("/a/joint_states");
  auto stalled = Reader<ros::Bool>("/a/stalled");
  TickUntilReceived(stalled, [](const ros::Bool&) {});
  const auto writers = UserDataOf(participant_.participant().handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION);
  EXPECT_TRUE(writers.contains("rt/a/stalled"));
  EXPECT_FALSE(writers.contains("rt/a/joint_states"));
}

TEST_F(RobotTopicsTest, ARobotHasItsTopicsBelowItsNamespace) {
  WorldDescription world = TwoRobots();
  world.robots[0].ros.name_space = "/fleet/a";
  MakeReplica(options_, world);
  auto odom = Reader<ros::OdometryMessage>("/fleet/a/odom");
  TickUntilReceived(odom, [](const auto& message) { EXPECT_STREQ(message.header.frame_id, "fleet/a/odom"); });
}

TEST_F(RobotTopicsTest, EachEndpointHasTheHashOfItsType) {
  MakeReplica(options_);
  for (const dds_entity_t discovered : {DDS_BUILTIN_TOPIC_DCPSPUBLICATION, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION}) {
    std::map<std::string, std::string> all;
    ASSERT_TRUE(Eventually([&] {
      all = UserDataOf(participant_.participant().handle(), discovered);
      return all.size() > 5;
    }));
    for (const auto& [topic, user_data] : all) {
      if (topic.starts_with("DCPS")) continue;  // of discovery itself, in this process
      EXPECT_THAT(user_data, testing::ContainsRegex("(^|;)typehash=RIHS01_[0-9a-f]{64};")) << topic;
    }
    EXPECT_EQ(all.contains("ros_discovery_info"), discovered == DDS_BUILTIN_TOPIC_DCPSPUBLICATION);
  }
}

// The cost of discovery grows with the number of endpoints. Up to a hundred robots have services for parameters, too.
TEST_F(RobotTopicsTest, HasADozenEndpointsForEachOfManyRobots) {
  SmallWorld world;
  for (int i = 0; i < 101; ++i) {
    const RobotId robot = world.AddRobot("r" + std::to_string(i), {2.0 * i, 0.0, 0.0, 0.0});
    world.AddRanger(robot, {0.1, 0.0, 0.3, 0.0}, {Fan(1.0, 5)});
    world.AddRanger(robot, {0.0, 0.0, 0.2, 0.0}, {OneRay(), OneRay(4.0)});
  }
  MakeReplica(options_, world.world());
  using Info = rmw_dds_common_msg_dds__ParticipantEntitiesInfo_;
  dds::Topic<Info> name(participant_.participant(), "ros_discovery_info");
  dds::DataReader<Info> infos(participant_.subscriber(), name, ros::ToDds(ros::Latched()));
  std::size_t robots = 0;
  EXPECT_TRUE(Eventually([&] {
    for (const auto sample : infos.take()) {
      for (const auto& node : dds::Elements(sample.data().node_entities_info_seq)) {
        ++robots;
        // The first robot also has tf and tf_static, for all.
        EXPECT_LE(node.reader_gid_seq._length + node.writer_gid_seq._length, robots == 1 ? 14u : 12u)
            << node.node_namespace;
      }
    }
    return robots >= 101;
  }));
  EXPECT_EQ(robots, 101u);
}

}  // namespace
}  // namespace troupe
