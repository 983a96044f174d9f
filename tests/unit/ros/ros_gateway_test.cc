#include "robot-agent/ros/ros_gateway.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/dds/wire.h"
#include "common/ros_dds/ros_endpoints.h"
#include "common/ros_dds/ros_qos.h"
#include "robot-agent/agent/replica.h"
#include "tests/support/dds_domain.h"
#include "tests/support/ros_domain.h"
#include "tests/support/small_world.h"

// What a broken or hostile peer may send: one byte under the name of a Twist.
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

// A ROS node on the other side of the network, and an agent's replica to exchange messages with.
class RosGatewayTest : public testing::Test {
 protected:
  void MakeReplica(const ros::RosOptions& options) {
    Result<std::unique_ptr<Replica>> replica = Replica::Create(TwoRobots(), {}, nullptr, 1, MakeRosGateway(options));
    ASSERT_TRUE(replica.ok());
    replica_ = std::move(replica).value();
  }

  ProposalMessage Tick() {
    ProposalMessage answer;
    replica_->Answer(state_, answer);
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

  // Ticks until `reader` has got something, and calls `check` with the last message.
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

  // The twist proposed for robot a once the command was obeyed. It is repeated, because a reader that has not yet met
  // the writer misses it.
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

  ros::RosOptions options_ = test::TestRosOptions();
  ros::RosParticipant participant_{options_};
  ros::RosNode peer_ = ros::MakeNode(participant_, "/", "peer");
  WorldState state_ = InitialState(TwoRobots());
  std::unique_ptr<Replica> replica_;
};

ros::TwistMessage Twist2(double vx, double wz) {
  ros::TwistMessage twist{};
  twist.linear.x = vx;
  twist.angular.z = wz;
  return twist;
}

TEST_F(RosGatewayTest, PublishesWhatTheRobotKnowsOfItself) {
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
  });
  TickUntilReceived(truth, [](const ros::OdometryMessage& message) {
    EXPECT_STREQ(message.header.frame_id, "map");
    EXPECT_EQ(message.pose.pose.position.x, 3.0);
  });
  TickUntilReceived(stalled, [](const ros::Bool& message) { EXPECT_TRUE(message.data); });
}

TEST_F(RosGatewayTest, PublishesScansAndRanges) {
  MakeReplica(options_);
  auto scans = Reader<ros::LaserScan>("/a/scan");
  auto ranges = Reader<ros::RangeMessage>("/a/sonar");
  TickUntilReceived(scans, [](const ros::LaserScan& scan) {
    EXPECT_STREQ(scan.header.frame_id, "a/scan");
    ASSERT_EQ(scan.ranges._length, 5u);
    EXPECT_FLOAT_EQ(scan.ranges._buffer[2], 2.7F);  // from x = 0.1 to b's side at 2.8
    EXPECT_EQ(scan.ranges._buffer[0], 5.0F);
  });
  std::vector<std::string> frames;
  ASSERT_TRUE(Eventually([&] {
    Tick();
    ranges.Drain([&](const ros::RangeMessage& range) {
      frames.emplace_back(range.header.frame_id);
      EXPECT_FLOAT_EQ(range.range, 2.8F);
    });
    return frames.size() >= 2;
  }));
  EXPECT_EQ(frames[0], "a/sonar_0");
  EXPECT_EQ(frames[1], "a/sonar_1");
}

TEST_F(RosGatewayTest, SpeaksTheRangeOfHumbleToHumble) {
  options_.distribution = ros::Distribution::kHumble;
  MakeReplica(options_);
  auto ranges = Reader<ros::HumbleRangeMessage>("/a/sonar");
  TickUntilReceived(ranges, [](const ros::HumbleRangeMessage& range) { EXPECT_FLOAT_EQ(range.range, 2.8F); });
}

// From frame to its parent.
std::map<std::string, std::string> ParentsOf(const ros::TfMessage& message) {
  std::map<std::string, std::string> parents;
  for (const ros::TransformStamped& transform : dds::Elements(message.transforms)) {
    EXPECT_TRUE(parents.emplace(transform.child_frame_id, transform.header.frame_id).second);
  }
  return parents;
}

TEST_F(RosGatewayTest, ClosesTheTreeOfFrames) {
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

TEST_F(RosGatewayTest, GivesEachRobotTransformsOfItsOwnIfAsked) {
  options_.namespaced_tf = true;
  options_.map_to_odom = false;
  MakeReplica(options_);
  auto moving = Reader<ros::TfMessage>("/b/tf");
  auto fixed = Reader<ros::TfMessage>("/b/tf_static", true);
  TickUntilReceived(moving, [](const ros::TfMessage& message) {
    EXPECT_EQ(ParentsOf(message), (std::map<std::string, std::string>{{"base_link", "odom"}}));
  });
  TickUntilReceived(fixed, [](const ros::TfMessage& message) {
    EXPECT_EQ(ParentsOf(message), (std::map<std::string, std::string>{
                                      {"scan", "base_link"}, {"sonar_0", "base_link"}, {"sonar_1", "base_link"}}));
  });
}

TEST_F(RosGatewayTest, ObeysACommandInTheNextProposal) {
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, -0.25)), (Twist{0.5, 0.0, -0.25}));
  const ProposalMessage answer = Tick();
  EXPECT_EQ(answer.proposals[0].twist, (Twist{0.5, 0.0, -0.25}));  // goes on
  EXPECT_TRUE(answer.proposals[1].twist.IsZero());
}

TEST_F(RosGatewayTest, StopsARobotWhoseCommandsDryUp) {
  options_.command_timeout = 1.0;  // 10 ticks
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  CommandUntilMoving(commands, Twist2(0.5, 0.0));
  int ticks = 0;
  ASSERT_TRUE(Eventually([&] {
    ++ticks;
    return Tick().proposals[0].twist.IsZero();
  }));
  EXPECT_GE(ticks, 10);  // more where the last repetition came late
}

TEST_F(RosGatewayTest, TakesStampedCommandsOfBothTypesIfAsked) {
  options_.command_type = ros::CommandType::kBoth;
  options_.command_timeout = 0.0;
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

TEST_F(RosGatewayTest, MeetsNobodyWhoUsesItsTopicsWithAnotherType) {
  MakeReplica(options_);
  auto commands = Writer<ros::Bool>("/a/cmd_vel");
  auto odom = Reader<ros::Bool>("/a/odom");
  auto stalled = Reader<ros::Bool>("/a/stalled");
  commands.Write({true});
  TickUntilReceived(stalled, [](const ros::Bool&) {});
  EXPECT_FALSE(commands.wanted());
  odom.Drain([](const ros::Bool&) { FAIL() << "an odometry message as a Bool"; });
  EXPECT_THAT(Tick().reports, IsEmpty());
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

TEST_F(RosGatewayTest, TakesTheLatestOfManyCommands) {
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  CommandUntilMoving(commands, Twist2(0.5, 0.0));
  for (int i = 1; i <= 10'000; ++i) commands.Write(Twist2(1e-4 * i, 0.0));
  EXPECT_TRUE(Eventually([&] { return Tick().proposals[0].twist.vx == 1.0; }));
}

}  // namespace
}  // namespace troupe
