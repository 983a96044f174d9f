// Tools of ROS that stay on this machine, as its environment asks, find a run that stays there too.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <map>
#include <string>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/own_network.h"
#include "tests/support/ros_domain.h"
#include "tests/support/ros_graph.h"
#include "tests/support/ros_tool.h"

namespace troupe::test {
namespace {

void ExpectRunFoundBy(const char* tool_xml) {
  const std::uint32_t domain = TestRosNetwork().domain;
  setenv("ROS_DOMAIN_ID", std::to_string(domain).c_str(), 1);
  RosTool early(domain, tool_xml);
  Program run = RunPen({"--ros", "--speed", "1"});
  run.WaitForLine(", ready");
  for (const char* topic : {"/clock", "/r0/odom", "/r1/odom", "/r2/odom", "/r3/odom"}) {
    EXPECT_TRUE(Eventually([&] { return early.Topics().contains(topic); })) << topic;
  }
  run.Interrupt();
}

TEST(RosDiscovery, OfHumbleOnLocalhost) {
  HasNetworkOfItsOwn();
  setenv("ROS_DISTRO", "humble", 1);
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  ExpectRunFoundBy(kHumbleLocalhost);
}

TEST(RosDiscovery, OfJazzyOnLocalhost) {
  HasNetworkOfItsOwn();
  setenv("ROS_DISTRO", "jazzy", 1);
  unsetenv("ROS_LOCALHOST_ONLY");
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1);
  ExpectRunFoundBy(kJazzyLocalhost);
}

// The endpoints of services that end so.
std::size_t CountServices(RosGraph& graph, const std::string& ending) {
  const std::multimap<std::string, std::string> all = graph.UserData();
  return static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [&](const auto& endpoint) { return endpoint.first.ends_with(ending); }));
}

// Tools of Jazzy wait for all six of a node.
TEST(RosDiscovery, TheNodesOfAHundredRobotsHaveAllParameterServicesAndThoseOfMoreHaveNone) {
  for (const std::size_t robots : {100u, 101u}) {
    const TemporaryFolder folder;
    const std::string file = folder.Write(
        "many.json", R"({"world": ")" + WorldPath("pen.world") + R"(", "spawn": [{"model": "rover", "count": )" +
                         std::to_string(robots - 4) + R"(, "region": [4, -40, 80, 40]}]})");
    Program run =
        Troupe(Words("run % --headless --paused --in-process --domain %", {file, std::to_string(TestDomain())}) +
               RosArguments({"--ros-services", "cyclone", "--ros-distro", "jazzy"}));
    run.WaitForLine(", ready");
    RosGraph graph;
    EXPECT_TRUE(Eventually([&] { return CountServices(graph, "/odom") == robots; }));
    for (const char* service : {"/list_parameters", "/get_parameters", "/get_parameter_types", "/describe_parameters",
                                "/set_parameters", "/set_parameters_atomically", "/get_type_description"}) {
      const std::size_t expected = (robots > 100 ? 0 : robots) + 1;  // that of the world
      EXPECT_TRUE(Eventually([&] { return CountServices(graph, service + std::string("Request")) == expected; }))
          << service << " of " << robots;
    }
    run.Interrupt();
  }
}

TEST(RosDiscovery, AnEnvironmentThatIsNotValidIsAnErrorUnlessAnOptionReplacesIt) {
  unsetenv("ROS_LOCALHOST_ONLY");
  unsetenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
  setenv("ROS_DISTRO", "jazzy", 1);
  for (const char* domain : {"abc", "240"}) {
    setenv("ROS_DOMAIN_ID", domain, 1);
    EXPECT_THAT(OutputOf(RunPen({"--ros", "--ticks", "1"}), 2),
                testing::HasSubstr("error: ROS_DOMAIN_ID: found '" + std::string(domain) + "'"));
  }
  const std::string domain = std::to_string(TestRosNetwork().domain);
  EXPECT_EQ(Finish(RunPen({"--ros", "--ros-domain", domain, "--ticks", "1"})).exit_status, 0);
  EXPECT_EQ(Finish(RunPen({"--no-ros", "--ticks", "1"})).exit_status, 0);
  setenv("ROS_DOMAIN_ID", domain.c_str(), 1);
  setenv("ROS_DISTRO", "foxy", 1);
  EXPECT_THAT(OutputOf(RunPen({"--ros", "--ticks", "1"}), 2),
              testing::HasSubstr("error: ROS_DISTRO: found 'foxy', expected humble"));
  setenv("ROS_DISTRO", "jazzy", 1);
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCAL", 1);
  EXPECT_THAT(OutputOf(RunPen({"--ros", "--ticks", "1"})),
              testing::HasSubstr("warning: ROS_AUTOMATIC_DISCOVERY_RANGE: found 'LOCAL'"));
}

}  // namespace
}  // namespace troupe::test
