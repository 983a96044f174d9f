// Runs in a ROS domain with security, as ROS 2's own tools set it up (SROS 2).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>

#include "ros/connection/ros_endpoints.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_graph.h"
#include "tests/support/ros_keystore.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kNamespaces[] = {"/r0", "/r1", "/r2", "/r3"};

std::vector<std::string> InRosDomain(std::vector<std::string> arguments) {
  const ros::RosNetwork options = TestRosNetwork();
  arguments.insert(arguments.end(), {"--ros", "--ros-domain=" + std::to_string(options.domain), "--ros-interface=lo"});
  return arguments;
}

class RosSecurity : public testing::Test {
 protected:
  void TearDown() override {
    for (const char* name : {"ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY", "ROS_SECURITY_KEYSTORE"}) unsetenv(name);
  }

  // For the programs that the test starts.
  void SetEnvironment(const char* strategy, const std::string& keystore) {
    setenv("ROS_SECURITY_ENABLE", "true", 1);
    setenv("ROS_SECURITY_STRATEGY", strategy, 1);
    setenv("ROS_SECURITY_KEYSTORE", keystore.c_str(), 1);
  }

  ros::RosNetwork SecuredOptions() const {
    ros::RosNetwork options = TestRosNetwork();
    options.security = {ros::SecurityStrategy::kEnforce, keystore_.path(), {}, {}};
    return options;
  }

  // With the keys of a tool, all of the graph is visible; without keys, nothing.
  void ExpectVisibleWithKeysOnly(const std::vector<std::string>& arguments) {
    keystore_.AddEnclave("/tool");
    RosGraph secured(SecuredOptions(), "/tool");
    RosGraph open;
    Program run = RunPen(InRosDomain(arguments));
    EXPECT_TRUE(Eventually([&] {
      const std::set<std::string> topics = secured.Topics("/");
      return topics.contains("/clock") && topics.contains("/r0/odom") && topics.contains("/r3/odom");
    })) << run.output();
    EXPECT_TRUE(Eventually([&] {
      const std::vector<std::string> nodes = secured.Nodes();
      return std::count(nodes.begin(), nodes.end(), "/world") == 1 &&
             std::count(nodes.begin(), nodes.end(), "/r0/robot") == 1;
    }));
    EXPECT_THAT(open.Topics("/"), IsEmpty());
    EXPECT_THAT(open.Nodes(), IsEmpty());
    run.Interrupt();
  }

  const TemporaryFolder folder_;
  const RosKeystore keystore_{folder_.Path(""), TestRosNetwork().domain};
};

TEST_F(RosSecurity, ARunIsVisibleWithKeysOnly) {
  keystore_.AddEnclave("/world");
  for (const char* robot : kNamespaces) keystore_.AddEnclave(robot);
  SetEnvironment("Enforce", keystore_.path());
  ExpectVisibleWithKeysOnly({"--speed", "10"});
}

TEST_F(RosSecurity, ARunInOneProcessIsVisibleWithKeysOnly) {
  keystore_.AddEnclave("/world");
  SetEnvironment("Enforce", keystore_.path());
  // Cyclone's plugins do not free some tokens of participants that share a domain in a process: 180 bytes for each.
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
  ExpectVisibleWithKeysOnly({"--speed", "10", "--in-process"});
  unsetenv("ASAN_OPTIONS");
}

TEST_F(RosSecurity, AllProcessesCanHaveOneEnclave) {
  keystore_.AddEnclave("/swarm");
  SetEnvironment("Enforce", keystore_.path());
  ExpectVisibleWithKeysOnly({"--speed", "10", "--ros-enclave", "/swarm"});
}

TEST_F(RosSecurity, RequiredKeysThatAreMissingEndTheRunWithOneLine) {
  keystore_.AddEnclave("/world");
  keystore_.AddEnclave("/r0");
  std::filesystem::remove(folder_.Path("enclaves/r0/key.pem"));
  SetEnvironment("Enforce", keystore_.path());
  const std::string robot = OutputOf(RunPen(InRosDomain({"--ticks", "5"})), 2);
  EXPECT_THAT(robot, HasSubstr(folder_.Path("enclaves/r0/key.pem") + ": error: cannot read"));
  EXPECT_EQ(std::count(robot.begin(), robot.end(), '\n'), 1);
  std::filesystem::remove_all(folder_.Path("enclaves/world"));
  for (const char* mode : {"--headless", "--in-process"}) {
    const std::string run = OutputOf(RunPen(InRosDomain({"--ticks", "5", mode})), 2);
    EXPECT_THAT(run, HasSubstr(folder_.Path("enclaves/world") + ": error: found no such folder")) << mode;
    EXPECT_EQ(std::count(run.begin(), run.end(), '\n'), 1);
  }
}

TEST_F(RosSecurity, TheProgramsLookForTheirKeysThemselves) {
  SetEnvironment("Enforce", keystore_.path());
  EXPECT_THAT(OutputOf(Program({ProgramPath("world-service"), WorldPath("pen.world"), "--session", TestSession("keys"),
                                "--domain", std::to_string(TestDomain()), "--ros"}),
                       2),
              HasSubstr(folder_.Path("enclaves/world") + ": error: found no such folder"));
  EXPECT_THAT(OutputOf(Program({ProgramPath("robot-agent"), "--session", TestSession("keys"), "--domain",
                                std::to_string(TestDomain()), "--robot", "r0", "--ros"}),
                       2),
              HasSubstr(folder_.Path("enclaves/r0") + ": error: found no such folder"));
}

TEST_F(RosSecurity, OptionalKeysThatAreMissingAreAWarning) {
  SetEnvironment("Permissive", keystore_.path());
  for (const char* mode : {"--headless", "--in-process"}) {
    const std::string run = OutputOf(RunPen(InRosDomain({"--ticks", "5", mode})));
    EXPECT_THAT(run, HasSubstr(folder_.Path("enclaves/world") + ": warning: ")) << mode;
    EXPECT_THAT(run, HasSubstr("continuing without security")) << mode;
  }
}

TEST_F(RosSecurity, BadValuesAreErrorsOfRunsWithRosOnly) {
  SetEnvironment("Strict", keystore_.path());
  const std::string run = OutputOf(RunPen(InRosDomain({"--ticks", "5"})), 2);
  EXPECT_EQ(run, "error: ROS_SECURITY_STRATEGY: found 'Strict', expected Enforce or Permissive\n");
  EXPECT_EQ(Finish(RunPen({"--ticks", "5", "--in-process"})).exit_status, 0);
}

}  // namespace
}  // namespace troupe::test
