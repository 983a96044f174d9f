// A fleet with a ROS domain for each robot, in a network of the test's own: a tool in one domain sees one robot, under
// plain names, and the run is the same as without ROS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/own_network.h"
#include "tests/support/ros_domain.h"
#include "tests/support/ros_graph.h"

namespace troupe::test {
namespace {

constexpr int kRobots = 50;

class RosDomains : public testing::Test {
 protected:
  RosDomains() {
    std::ofstream(folder_.Path("fleet.json"))
        << R"({"world": ")" << WorldPath("pen.world") << R"(", "ros": true, "spawn": [{"model": "rover", "count": )"
        << kRobots << R"(, "region": [4, -40, 80, 40], "controller": "wander", "ros_domain": {"each": )" << kFirstDomain
        << "}}]}";
  }
  std::vector<std::string> ArgumentsWithoutRos(std::vector<std::string> more) const {
    return Words("run % --headless --session % --domain %",
                 {folder_.Path("fleet.json"), TestSession("domains"), std::to_string(kSimulationDomain)}) +
           more;
  }
  std::vector<std::string> Arguments(std::vector<std::string> more) const {
    return ArgumentsWithoutRos(Words("--ros-interface lo --ros-domain %", {std::to_string(kRunDomain)}) + more);
  }

  TemporaryFolder folder_;
};

TEST_F(RosDomains, AToolInADomainSeesOneRobotUnderPlainNames) {
  if (!HasNetworkOfItsOwn()) GTEST_SKIP() << "needs root and network namespaces";
  Program run = Troupe(Arguments({"--paused"}));
  run.WaitForLine(", ready");
  for (const std::uint32_t domain : {kFirstDomain, kFirstDomain + 17, kFirstDomain + kRobots - 1}) {
    RosGraph graph(InDomain(domain));
    std::vector<std::string> nodes;
    EXPECT_TRUE(Eventually([&] { return (nodes = graph.Nodes()) == std::vector<std::string>{"/robot"}; }))
        << domain << ": " << testing::PrintToString(nodes);
    EXPECT_TRUE(Eventually([&] { return graph.Topics("/").contains("/scan"); }));
    EXPECT_THAT(graph.Topics("/"),
                testing::IsSupersetOf({"/clock", "/map", "/odom", "/tf", "/tf_static", "/sonar", "/rosout"}));
  }
  // The four robots of the world file and the world itself.
  RosGraph graph(InDomain(kRunDomain));
  std::vector<std::string> nodes;
  EXPECT_TRUE(Eventually([&] {
    return (nodes = graph.Nodes()) ==
           std::vector<std::string>{"/r0/robot", "/r1/robot", "/r2/robot", "/r3/robot", "/world"};
  })) << testing::PrintToString(nodes);
  run.Interrupt();
}

TEST_F(RosDomains, TheRunIsTheSameAsWithoutRos) {
  if (!HasNetworkOfItsOwn()) GTEST_SKIP() << "needs root and network namespaces";
  std::string hashes[2];
  for (const bool ros : {false, true}) {
    TemporaryFolder outputs;
    const std::vector<std::string> of_run = {"--ticks", "50", "--hash-log", outputs.Path("hashes")};
    OutputOf(Troupe(ros ? Arguments(of_run) : ArgumentsWithoutRos(std::vector<std::string>{"--no-ros"} + of_run)));
    hashes[ros ? 1 : 0] = outputs.Read("hashes");
  }
  EXPECT_FALSE(hashes[0].empty());
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(RosDomains, TimeAdvancesBetweenTicksInTheDomainOfARobot) {
  if (!HasNetworkOfItsOwn()) GTEST_SKIP() << "needs root and network namespaces";
  ros::RosParticipant participant(InDomain(kFirstDomain));
  ros::RosReader<ros::Clock> reader(ros::MakeNode(participant, "/", "reader"), "/clock", ros::Stream(10'000));
  Program run = Troupe(Arguments({"--speed", "1", "--ros-clock-rate", "100", "--ticks", "40"}));
  ASSERT_EQ(run.Wait(), 0) << run.output();
  std::vector<std::int64_t> times;
  reader.Drain([&](const ros::Clock& clock) {
    times.push_back(clock.clock.sec * std::int64_t{1'000'000'000} + clock.clock.nanosec);
  });
  ASSERT_FALSE(times.empty());
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  // 400 on an idle machine.
  EXPECT_GT(std::set<std::int64_t>(times.begin(), times.end()).size(), 45u) << "of 40 ticks";
}

TEST_F(RosDomains, ARobotCannotHaveTheDomainOfTheSimulation) {
  std::vector<std::string> arguments = Arguments({});
  *(std::find(arguments.begin(), arguments.end(), "--domain") + 1) = "3";
  const std::string finished = OutputOf(Troupe(std::move(arguments)), 2);
  EXPECT_THAT(finished,
              testing::HasSubstr("error: found the ROS domain 3 for robot 'rover2', which is the domain of the "
                                 "simulation, expected another one, or another --domain"));
}

}  // namespace
}  // namespace troupe::test
