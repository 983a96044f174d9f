// Programs in the ROS domain that do not match the gateway, or are broken or hostile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "tests/support/dds_domain.h"
#include "tests/support/garbage_sender.h"
#include "tests/support/ros_gateway_fixture.h"
#include "transport/dds/binding/data_writer.h"

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

using OtherProgramsTest = test::RosGatewayFixture;
using test::Eventually;
using test::Twist2;
using testing::ElementsAre;
using testing::IsEmpty;

TEST_F(OtherProgramsTest, ReportsPublishersOfAnotherType) {
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

TEST_F(OtherProgramsTest, ReportsUnreliablePublishersIfReliableOnesAreRequired) {
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

TEST_F(OtherProgramsTest, ReportsAHumbleParticipantInTheDomainOfLaterOnesOnce) {
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

TEST_F(OtherProgramsTest, ReportsALaterParticipantInTheDomainOfHumble) {
  options_.network.distribution = ros::Distribution::kHumble;
  MakeReplica(options_);  // the peer of this test is of Jazzy
  std::vector<std::string> reports;
  EXPECT_TRUE(Eventually([&] {
    reports = Tick().reports;
    return !reports.empty();
  }));
  EXPECT_THAT(reports, ElementsAre(testing::HasSubstr("is of Iron or later, and this run is for humble")));
}

TEST_F(OtherProgramsTest, SurvivesCommandsOfAnotherLayout) {
  MakeReplica(options_);
  auto malformed = Writer<Malformed>("/a/cmd_vel");
  ASSERT_TRUE(Eventually([&] { return malformed.wanted(); }));
  for (int i = 0; i < 100; ++i) malformed.Write({1});
  auto stalled = Reader<ros::Bool>("/a/stalled");
  TickUntilReceived(stalled, [](const ros::Bool&) {});
  EXPECT_TRUE(Tick().proposals[0].twist.IsZero());
}

TEST_F(OtherProgramsTest, SurvivesASpoofedListOfNodes) {
  MakeReplica(options_);
  dds::Topic<Spoofed> malformed_name(participant_.participant(), "ros_discovery_info");
  dds::DataWriter<Spoofed> malformed(participant_.publisher(), malformed_name, ros::ToDds(ros::Latched()));
  for (int i = 0; i < 100; ++i) malformed.write({1});
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, 0.0)).vx, 0.5);
}

// Announcements of participants and writers with random contents, from an unknown sender and in the name of a live
// peer.
TEST_F(OtherProgramsTest, SurvivesGarbageInDiscovery) {
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

}  // namespace
}  // namespace troupe
