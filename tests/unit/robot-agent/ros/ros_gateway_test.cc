#include "robot-agent/ros/ros_gateway.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "robot-agent/agent/replica.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/world_topics.h"
#include "ros/messages/convert.h"
#include "tests/support/dds_domain.h"
#include "tests/support/garbage_sender.h"
#include "tests/support/gripper_world.h"
#include "tests/support/host_participant.h"
#include "tests/support/ros_domain.h"
#include "tests/support/ros_graph.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "transport/dds/binding/wire.h"

// A message of a broken or hostile peer: one byte under the name of a Twist.
struct Malformed {
  std::uint8_t byte;
};
template <>
struct troupe::dds::TopicTraits<Malformed> {
  static const dds_topic_descriptor_t* descriptor() {
    static const dds_topic_descriptor_t renamed = [] {
      dds_topic_descriptor_t copy = std_msgs_msg_dds__Bool__desc;
      copy.m_typename = "geometry_msgs::msg::dds_::Twist_";
      return copy;
    }();
    return &renamed;
  }
};

// The same under the name of a list of nodes.
struct Spoofed {
  std::uint8_t byte;
};
template <>
struct troupe::dds::TopicTraits<Spoofed> {
  static const dds_topic_descriptor_t* descriptor() {
    static const dds_topic_descriptor_t renamed = [] {
      dds_topic_descriptor_t copy = std_msgs_msg_dds__Bool__desc;
      copy.m_typename = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";
      return copy;
    }();
    return &renamed;
  }
};

namespace troupe {
namespace {

using test::Eventually;
using testing::ElementsAre;
using testing::IsEmpty;

// Robots a and b, each with a scanner of 5 rays and two sonars, on odometry.
WorldDescription TwoRobots() {
  SmallWorld world;
  for (const char* name : {"a", "b"}) {
    const RobotId robot = world.AddRobot(name, {name[0] == 'a' ? 0.0 : 3.0, 0.0, 0.0, 0.0});
    world.AddRanger(robot, {0.1, 0.0, 0.3, 0.0}, {Fan(1.0, 5)});
    world.AddRanger(robot, {0.0, 0.0, 0.2, 0.0}, {OneRay(), OneRay(4.0)});
    world.robot(robot).localization.type = LocalizationType::kOdometry;
    world.robot(robot).localization.origin = {1.0, 2.0, 0.0, 0.5};
  }
  return world.world();
}

// Robots a and b, each with a gripper on a lift and a scanner that the lift raises. The lift is at 0.25 m, and b's left
// finger has moved 0.05 m.
test::GripperWorld TwoGrippers() {
  test::GripperWorld world;
  for (const char* name : {"a", "b"}) {
    const test::GripperRobot parts = world.AddGripperRobot({name[0] == 'a' ? 0.0 : 3.0, 0.0, 0.0, 0.0});
    world.model(parts.root).name = world.world.robots.back().name = name;
    const char* names[] = {"gripper.lift", "gripper.left", "gripper.right"};
    for (const JointId joint : {parts.lift, parts.left, parts.right}) {
      world.world.joints[joint.index()].name = names[joint.index() % 3];
    }
    SensorDescription ranger{.name = "ranger:0",
                             .model = world.AddModel(std::vector<Block>(), {0.0, 0.0, 0.5, 0.0}, parts.carriage)};
    RaySensors(ranger) = {Fan(1.0, 5)};
    world.world.robots.back().sensors = {ranger};
  }
  return world;
}

// The user data of all endpoints that `discovered` announces, by topic.
std::map<std::string, std::string> UserDataOf(dds_entity_t participant, dds_entity_t discovered) {
  const dds::Entity endpoints(dds::Check(dds_create_reader(participant, discovered, nullptr, nullptr), "reading"));
  constexpr std::uint32_t kMost = 1000;
  std::vector<void*> samples(kMost, nullptr);
  std::vector<dds_sample_info_t> infos(kMost);
  std::map<std::string, std::string> all;
  const dds_return_t count = dds_read(endpoints.handle(), samples.data(), infos.data(), kMost, kMost);
  for (dds_return_t i = 0; i < count; ++i) {
    const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(samples[static_cast<std::size_t>(i)]);
    void* bytes = nullptr;
    std::size_t size = 0;
    if (dds_qget_userdata(endpoint.qos, &bytes, &size) && bytes != nullptr) {
      all[endpoint.topic_name].assign(static_cast<const char*>(bytes), size);
      dds_free(bytes);
    } else {
      all[endpoint.topic_name] = "";
    }
  }
  if (count > 0) dds_return_loan(endpoints.handle(), samples.data(), count);
  return all;
}

// A ROS node across the network, and an agent's replica that it exchanges messages with.
class RosGatewayTest : public testing::Test {
 protected:
  void MakeReplica(ros::RosOptions options, const WorldDescription& world = TwoRobots()) {
    state_ = PlacedState(world);
    replica_.reset();
    host_.reset();
    options.socket = host_.emplace(options.network).socket();
    replica_ =
        test::ValueOf(Replica::Create(std::make_shared<const Scene>(world), {}, {}, {}, MakeRosGateway(options)));
  }

  ProposalMessage Tick() {
    const ProposalMessage answer = replica_->Decide(state_);
    replica_->Publish(state_);
    ++state_.tick;
    return answer;
  }

  template <typename T>
  ros::RosReader<T> Reader(const std::string& topic, bool latched = false) {
    return ros::RosReader<T>(peer_, topic, latched ? ros::Latched() : ros::Stream(100));
  }
  template <typename T>
  ros::RosWriter<T> Writer(const std::string& topic) {
    return ros::RosWriter<T>(peer_, topic, ros::Stream(1));
  }

  // Ticks until `reader` has received a message, and calls `check` with the last one.
  template <typename T, typename Check>
  void TickUntilReceived(ros::RosReader<T>& reader, const Check& check) {
    bool received = false;
    ASSERT_TRUE(Eventually([&] {
      Tick();
      reader.Drain([&](const T& message) {
        if (!received) check(message);
        received = true;
      });
      return received;
    }));
  }

  // The twist proposed for robot a after the command. The command is repeated, because a reader misses a sample written
  // before it has discovered the writer.
  template <typename T>
  Twist CommandUntilMoving(ros::RosWriter<T>& commands, const T& command) {
    Twist twist;
    EXPECT_TRUE(Eventually([&] {
      commands.Write(command);
      twist = Tick().proposals[0].twist;
      return !twist.IsZero();
    }));
    return twist;
  }

  ros::RosOptions options_ = {.network = test::TestRosNetwork()};
  ros::RosParticipant participant_{options_.network};
  ros::RosNode peer_ = ros::MakeNode(participant_, "/", "peer");
  WorldState state_;
  std::optional<test::HostParticipant> host_;
  std::unique_ptr<Replica> replica_;
};

ros::TwistMessage Twist2(double vx, double wz) {
  ros::TwistMessage twist{};
  twist.linear.x = vx;
  twist.angular.z = wz;
  return twist;
}

TEST_F(RosGatewayTest, PublishesOdometryGroundTruthAndStall) {
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
TEST_F(RosGatewayTest, APauseAfterATickRepeatsNoOdometryOfARobotThatStays) {
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

TEST_F(RosGatewayTest, PublishesScansAndRanges) {
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

TEST_F(RosGatewayTest, PublishesCamerasCloudsAndTouches) {
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

TEST_F(RosGatewayTest, SendsTheRangeOfHumbleToHumble) {
  options_.network.distribution = ros::Distribution::kHumble;
  MakeReplica(options_);
  auto ranges = Reader<ros::HumbleRangeMessage>("/a/sonar");
  TickUntilReceived(ranges, [](const ros::HumbleRangeMessage& range) { EXPECT_FLOAT_EQ(range.range, 2.8F); });
}

// The parent of each frame.
std::map<std::string, std::string> ParentsOf(const ros::TfMessage& message) {
  std::map<std::string, std::string> parents;
  for (const ros::TransformStamped& transform : dds::Elements(message.transforms)) {
    EXPECT_TRUE(parents.emplace(transform.child_frame_id, transform.header.frame_id).second);
  }
  return parents;
}

TEST_F(RosGatewayTest, ConnectsTheTreeOfFrames) {
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

TEST_F(RosGatewayTest, MovesTheFramesOfJointsWithTheSensorsOnThem) {
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

TEST_F(RosGatewayTest, ARobotWithoutJointsHasNoJointStates) {
  MakeReplica(options_);
  auto joints = Reader<ros::JointStateMessage>("/a/joint_states");
  auto stalled = Reader<ros::Bool>("/a/stalled");
  TickUntilReceived(stalled, [](const ros::Bool&) {});
  const auto writers = UserDataOf(participant_.participant().handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION);
  EXPECT_TRUE(writers.contains("rt/a/stalled"));
  EXPECT_FALSE(writers.contains("rt/a/joint_states"));
}

TEST_F(RosGatewayTest, PublishesTransformsPerRobotIfAsked) {
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
TEST_F(RosGatewayTest, WritesTheTransformsOfATickBeforeItsScans) {
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

TEST_F(RosGatewayTest, LeavesTheTransformOfTheBaseToAnotherNodeIfAsked) {
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

// Robots a and b, each in a domain of its own.
WorldDescription TwoDomains(std::uint32_t of_a, std::uint32_t of_b) {
  WorldDescription world = TwoRobots();
  world.robots[0].ros.domain = of_a;
  world.robots[1].ros.domain = of_b;
  return world;
}

ros::RosNetwork InDomain(std::uint32_t domain) {
  ros::RosNetwork network = test::TestRosNetwork();
  network.domain = domain;
  return network;
}

TEST_F(RosGatewayTest, ARobotInADomainOfItsOwnIsAloneThereWithPlainNames) {
  const std::uint32_t domains[] = {test::ReserveDomain(), test::ReserveDomain()};
  MakeReplica(options_, TwoDomains(domains[0], domains[1]));
  ros::RosParticipant peer_of_b(InDomain(domains[1]));
  const ros::RosNode node = ros::MakeNode(peer_of_b, "/", "peer");
  ros::RosReader<ros::OdometryMessage> truth(node, "/ground_truth", ros::Stream(100));
  ros::RosReader<ros::Clock> clock(node, "/clock", ros::Stream(100));
  ros::RosReader<ros::OccupancyGridMessage> map(node, "/map", ros::Latched());
  ros::RosReader<ros::TfMessage> moving(node, "/tf", ros::Stream(100));
  ros::RosReader<ros::TfMessage> fixed(node, "/tf_static", ros::Latched());
  state_.tick = 100;
  TickUntilReceived(truth, [](const ros::OdometryMessage& message) { EXPECT_EQ(message.pose.pose.position.x, 3.0); });
  TickUntilReceived(clock, [](const ros::Clock& message) { EXPECT_GE(message.clock.sec, 10); });
  TickUntilReceived(map,
                    [](const ros::OccupancyGridMessage& message) { EXPECT_STREQ(message.header.frame_id, "map"); });
  TickUntilReceived(moving, [](const ros::TfMessage& message) {
    EXPECT_EQ(ParentsOf(message), (std::map<std::string, std::string>{{"base_link", "odom"}}));
  });
  TickUntilReceived(fixed, [](const ros::TfMessage& message) {
    const auto parents = ParentsOf(message);
    EXPECT_EQ(parents.at("base_footprint"), "base_link");
    EXPECT_EQ(parents.at("scan"), "base_link");
    EXPECT_EQ(parents.at("odom"), "map");
  });
  test::RosGraph graph(InDomain(domains[1]));
  EXPECT_TRUE(Eventually([&] { return graph.Nodes() == std::vector<std::string>{"/robot"}; }))
      << testing::PrintToString(graph.Nodes());
  const auto topics = graph.Topics("/");
  EXPECT_THAT(topics, testing::IsSupersetOf({"/odom", "/scan", "/sonar", "/rosout", "/parameter_events"}));
  EXPECT_THAT(topics, testing::Not(testing::Contains(testing::HasSubstr("/a/"))));
  test::RosGraph run(options_.network);
  EXPECT_TRUE(run.Nodes().empty()) << "nothing is in the domain of the run";
}

TEST_F(RosGatewayTest, ARobotObeysCommandsInItsDomain) {
  const std::uint32_t domains[] = {test::ReserveDomain(), test::ReserveDomain()};
  MakeReplica(options_, TwoDomains(domains[0], domains[1]));
  ros::RosParticipant peer_of_a(InDomain(domains[0]));
  const ros::RosNode node = ros::MakeNode(peer_of_a, "/", "peer");
  ros::RosWriter<ros::TwistMessage> commands(node, "/cmd_vel", ros::Stream(1));
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, -0.25)), (Twist{0.5, 0.0, -0.25}));
  EXPECT_TRUE(Tick().proposals[1].twist.IsZero());
}

TEST_F(RosGatewayTest, ASingleRobotCanHavePlainNamesInTheDomainOfTheRun) {
  options_.names.plain = true;
  MakeReplica(options_);
  auto first = Reader<ros::OdometryMessage>("/odom");
  auto second = Reader<ros::OdometryMessage>("/b/odom");
  TickUntilReceived(first, [](const auto& message) { EXPECT_STREQ(message.header.frame_id, "odom"); });
  TickUntilReceived(second, [](const auto& message) { EXPECT_STREQ(message.header.frame_id, "b/odom"); });
  test::RosGraph graph(options_.network);
  EXPECT_TRUE(Eventually([&] { return graph.Nodes() == std::vector<std::string>{"/b/robot", "/robot"}; }));
  EXPECT_FALSE(graph.Topics("/").contains("/clock")) << "that is the world's";
}

TEST_F(RosGatewayTest, ARobotHasItsTopicsBelowItsNamespace) {
  WorldDescription world = TwoRobots();
  world.robots[0].ros.name_space = "/fleet/a";
  MakeReplica(options_, world);
  auto odom = Reader<ros::OdometryMessage>("/fleet/a/odom");
  TickUntilReceived(odom, [](const auto& message) { EXPECT_STREQ(message.header.frame_id, "fleet/a/odom"); });
}

TEST_F(RosGatewayTest, LogsRefusedCommands) {
  MakeReplica(options_);
  ros::RosReader<rcl_interfaces_msg_dds__Log_> log(peer_, "/rosout", ros::LogLines());
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  std::string text;
  ASSERT_TRUE(Eventually([&] {
    commands.Write(Twist2(std::nan(""), 0.0));
    Tick();
    log.Drain([&](const rcl_interfaces_msg_dds__Log_& line) {
      text = std::string(line.name) + ": " + line.msg;
      EXPECT_EQ(line.level, 30);
      EXPECT_GT(line.stamp.sec, 0);
    });
    return !text.empty();
  }));
  EXPECT_THAT(text, testing::StartsWith("a.robot: robot a: cmd_vel: ignored a command"));
}

TEST_F(RosGatewayTest, ObeysACommandInTheNextProposal) {
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, -0.25)), (Twist{0.5, 0.0, -0.25}));
  const ProposalMessage answer = Tick();
  EXPECT_EQ(answer.proposals[0].twist, (Twist{0.5, 0.0, -0.25}));  // still valid
  EXPECT_TRUE(answer.proposals[1].twist.IsZero());
}

// Each writer writes as soon as it has discovered a reader, which may not have discovered the writer yet.
TEST_F(RosGatewayTest, ObeysACommandThatIsSentOnce) {
  options_.robots.command_timeout = 0.0;
  MakeReplica(options_);
  for (int i = 1; i <= 20; ++i) {
    auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
    ASSERT_TRUE(Eventually([&] { return commands.wanted(); }));
    commands.Write(Twist2(0.01 * i, 0.0));
    ASSERT_TRUE(Eventually([&] { return Tick().proposals[0].twist.vx == 0.01 * i; }, 5.0)) << "command " << i;
  }
}

TEST_F(RosGatewayTest, ReadsCommandsOfBestEffortWriters) {
  options_.robots.command_timeout = 0.0;
  MakeReplica(options_);
  ros::RosWriter<ros::TwistMessage> commands(peer_, "/a/cmd_vel", ros::Commands(false));
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, 0.0)).vx, 0.5);
}

// The reader beside a reliable one, which reads the messages of reliable writers.
TEST_F(RosGatewayTest, AReaderForBestEffortWritersLeavesReliableOnesToTheOther) {
  ros::RosParticipant here(options_.network);
  ros::RosReader<ros::Float64> reader(ros::MakeNode(here, "/", "reader"), "/number", ros::Commands(false, 100),
                                      ros::Part::kBestEffortReader);
  auto reliable = Writer<ros::Float64>("/number");
  std::vector<double> numbers;
  const auto drain = [&] { reader.Drain([&](const ros::Float64& number) { numbers.push_back(number.data); }); };
  const auto has_last = [&] {
    drain();
    return !numbers.empty() && numbers.back() == 3.0;
  };
  // A message that is not reliable may arrive after the end of its writer, and is lost then.
  for (int attempt = 0; attempt < 10 && !has_last(); ++attempt) {
    {
      ros::RosWriter<ros::Float64> best_effort(peer_, "/number", ros::Commands(false));
      ASSERT_TRUE(Eventually([&] { return reliable.wanted() && best_effort.wanted(); }));
      ASSERT_TRUE(Eventually([&] {
        reliable.Write({1.0});
        best_effort.Write({2.0});
        drain();
        return !numbers.empty();
      }));
      numbers.clear();
      reliable.Write({1.0});
      best_effort.Write({3.0});
    }
    Eventually(has_last, 1.0);  // the writer has left
  }
  EXPECT_TRUE(has_last());
  EXPECT_THAT(numbers, testing::Not(testing::Contains(1.0)));
}

TEST_F(RosGatewayTest, StopsARobotAfterTheCommandTimeout) {
  options_.robots.command_timeout = 1.0;  // 10 ticks
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  CommandUntilMoving(commands, Twist2(0.5, 0.0));
  int ticks = 0;
  ASSERT_TRUE(Eventually([&] {
    ++ticks;
    return Tick().proposals[0].twist.IsZero();
  }));
  EXPECT_GE(ticks, 10);  // more if the last repetition arrived late
}

TEST_F(RosGatewayTest, ReadsCommandsOfBothTypesIfAsked) {
  options_.robots.command_type = ros::CommandType::kBoth;
  options_.robots.command_timeout = 0.0;
  MakeReplica(options_);
  auto stamped = Writer<ros::TwistStamped>("/a/cmd_vel");
  auto plain = Writer<ros::TwistMessage>("/a/cmd_vel");
  char frame[] = "";
  EXPECT_EQ(CommandUntilMoving(stamped, ros::TwistStamped{{{}, frame}, Twist2(0.5, 0.0)}).vx, 0.5);
  EXPECT_TRUE(Eventually([&] {
    plain.Write(Twist2(0.25, 0.0));
    return Tick().proposals[0].twist.vx == 0.25;
  }));
}

TEST_F(RosGatewayTest, IgnoresCommandsThatAreNotFiniteAndSaysSo) {
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  std::vector<std::string> reports;
  ASSERT_TRUE(Eventually([&] {
    commands.Write(Twist2(std::numeric_limits<double>::quiet_NaN(), 0.0));
    const ProposalMessage answer = Tick();
    EXPECT_TRUE(answer.proposals[0].twist.IsZero());
    reports = answer.reports;
    return !reports.empty();
  }));
  EXPECT_THAT(reports, ElementsAre("robot a: cmd_vel: ignored a command that is not finite (1 so far)"));
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, 0.0)).vx, 0.5);
}

TEST_F(RosGatewayTest, ReportsPublishersOfAnotherType) {
  MakeReplica(options_);
  auto commands = Writer<ros::Bool>("/a/cmd_vel");
  auto odom = Reader<ros::Bool>("/a/odom");
  auto stalled = Reader<ros::Bool>("/a/stalled");
  commands.Write({true});
  std::vector<std::string> reports;
  EXPECT_TRUE(Eventually([&] {
    reports = Tick().reports;
    return !reports.empty();
  }));
  EXPECT_THAT(
      reports,
      ElementsAre("/a/cmd_vel: cannot read another program's publisher: its type is std_msgs/msg/Bool, expected "
                  "geometry_msgs/msg/Twist"));
  TickUntilReceived(stalled, [](const ros::Bool&) {});
  EXPECT_FALSE(commands.wanted());
  odom.Drain([](const ros::Bool&) { FAIL() << "an odometry message as a Bool"; });
  EXPECT_THAT(Tick().reports, IsEmpty()) << "once is enough";
}

TEST_F(RosGatewayTest, ReportsUnreliablePublishersIfReliableOnesAreRequired) {
  options_.robots.reliable_commands = true;
  MakeReplica(options_);
  ros::RosWriter<ros::TwistMessage> commands(peer_, "/b/cmd_vel", ros::Commands(false));
  ros::RosWriter<ros::TwistMessage> reliable(peer_, "/a/cmd_vel", ros::Stream(1));
  std::vector<std::string> reports;
  EXPECT_TRUE(Eventually([&] {
    reports = Tick().reports;
    return !reports.empty();
  }));
  EXPECT_THAT(
      reports,
      ElementsAre("/b/cmd_vel: cannot read another program's publisher: it is not reliable, expected a reliable "
                  "one"));
}

TEST_F(RosGatewayTest, EachEndpointHasTheHashOfItsType) {
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

TEST_F(RosGatewayTest, ReportsAHumbleParticipantInTheDomainOfLaterOnesOnce) {
  MakeReplica(options_);
  EXPECT_THAT(Tick().reports, IsEmpty());
  options_.network.distribution = ros::Distribution::kHumble;
  const ros::RosParticipant humble(options_.network);
  const ros::RosParticipant another(options_.network);
  std::vector<std::string> reports;
  EXPECT_TRUE(Eventually([&] {
    reports = Tick().reports;
    return !reports.empty();
  }));
  EXPECT_THAT(reports, ElementsAre(testing::HasSubstr("is of Humble, and this run is for jazzy")));
  EXPECT_THAT(Tick().reports, IsEmpty());
}

TEST_F(RosGatewayTest, ReportsALaterParticipantInTheDomainOfHumble) {
  options_.network.distribution = ros::Distribution::kHumble;
  MakeReplica(options_);  // the peer of this test is of Jazzy
  std::vector<std::string> reports;
  EXPECT_TRUE(Eventually([&] {
    reports = Tick().reports;
    return !reports.empty();
  }));
  EXPECT_THAT(reports, ElementsAre(testing::HasSubstr("is of Iron or later, and this run is for humble")));
}

TEST_F(RosGatewayTest, SurvivesASpoofedListOfNodes) {
  MakeReplica(options_);
  dds::Topic<Spoofed> malformed_name(participant_.participant(), "ros_discovery_info");
  dds::DataWriter<Spoofed> malformed(participant_.publisher(), malformed_name, ros::ToDds(ros::Latched()));
  for (int i = 0; i < 100; ++i) malformed.write({1});
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, 0.0)).vx, 0.5);
}

// Announcements of participants and writers with random contents, from an unknown sender and in the name of a live
// peer.
TEST_F(RosGatewayTest, SurvivesGarbageInDiscovery) {
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  CommandUntilMoving(commands, Twist2(0.25, 0.0));
  test::GarbageSender sender(options_.network.domain, participant_.participant().handle());
  for (std::uint64_t i = 0; i < 3000; ++i) sender.Send(i);
  EXPECT_TRUE(Eventually([&] {
    commands.Write(Twist2(0.5, 0.0));
    return Tick().proposals[0].twist.vx == 0.5;
  }));
}

// The cost of discovery grows with the number of endpoints. Up to a hundred robots have services for parameters, too.
TEST_F(RosGatewayTest, HasADozenEndpointsForEachOfManyRobots) {
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

TEST_F(RosGatewayTest, SurvivesCommandsOfAnotherLayout) {
  MakeReplica(options_);
  auto malformed = Writer<Malformed>("/a/cmd_vel");
  ASSERT_TRUE(Eventually([&] { return malformed.wanted(); }));
  for (int i = 0; i < 100; ++i) malformed.Write({1});
  auto stalled = Reader<ros::Bool>("/a/stalled");
  TickUntilReceived(stalled, [](const ros::Bool&) {});
  EXPECT_TRUE(Tick().proposals[0].twist.IsZero());
}

TEST_F(RosGatewayTest, AppliesTheLatestOfManyCommands) {
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  CommandUntilMoving(commands, Twist2(0.5, 0.0));
  for (int i = 1; i <= 10'000; ++i) commands.Write(Twist2(1e-4 * i, 0.0));
  EXPECT_TRUE(Eventually([&] { return Tick().proposals[0].twist.vx == 1.0; }));
}

}  // namespace
}  // namespace troupe
