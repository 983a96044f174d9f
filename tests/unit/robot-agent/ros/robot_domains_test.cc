// Robots in ROS domains of their own, and robots with plain names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "ros/connection/world_topics.h"
#include "tests/support/dds_domain.h"
#include "tests/support/ros_gateway_fixture.h"
#include "tests/support/ros_graph.h"

namespace troupe {
namespace {

using RobotDomainsTest = test::RosGatewayFixture;
using test::Eventually;
using test::ParentsOf;
using test::Twist2;
using test::TwoRobots;

// Robots a and b, each in a domain of its own.
WorldDescription TwoDomains(std::uint32_t of_a, std::uint32_t of_b) {
  WorldDescription world = TwoRobots();
  world.robots[0].ros.domain = of_a;
  world.robots[1].ros.domain = of_b;
  return world;
}

ros::RosNetwork TestNetworkIn(std::uint32_t domain) {
  ros::RosNetwork network = test::TestRosNetwork();
  network.domain = domain;
  return network;
}

TEST_F(RobotDomainsTest, ARobotInADomainOfItsOwnIsAloneThereWithPlainNames) {
  const std::uint32_t domains[] = {test::ReserveDomain(), test::ReserveDomain()};
  MakeReplica(options_, TwoDomains(domains[0], domains[1]));
  ros::RosParticipant peer_of_b(TestNetworkIn(domains[1]));
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
  test::RosGraph graph(TestNetworkIn(domains[1]));
  EXPECT_TRUE(Eventually([&] { return graph.Nodes() == std::vector<std::string>{"/robot"}; }))
      << testing::PrintToString(graph.Nodes());
  const auto topics = graph.Topics("/");
  EXPECT_THAT(topics, testing::IsSupersetOf({"/odom", "/scan", "/sonar", "/rosout", "/parameter_events"}));
  EXPECT_THAT(topics, testing::Not(testing::Contains(testing::HasSubstr("/a/"))));
  test::RosGraph run(options_.network);
  EXPECT_TRUE(run.Nodes().empty()) << "nothing is in the domain of the run";
}

TEST_F(RobotDomainsTest, ARobotObeysCommandsInItsDomain) {
  const std::uint32_t domains[] = {test::ReserveDomain(), test::ReserveDomain()};
  MakeReplica(options_, TwoDomains(domains[0], domains[1]));
  ros::RosParticipant peer_of_a(TestNetworkIn(domains[0]));
  const ros::RosNode node = ros::MakeNode(peer_of_a, "/", "peer");
  ros::RosWriter<ros::TwistMessage> commands(node, "/cmd_vel", ros::Stream(1));
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, -0.25)), (Twist{0.5, 0.0, -0.25}));
  EXPECT_TRUE(Tick().proposals[1].twist.IsZero());
}

TEST_F(RobotDomainsTest, ASingleRobotCanHavePlainNamesInTheDomainOfTheRun) {
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

}  // namespace
}  // namespace troupe
