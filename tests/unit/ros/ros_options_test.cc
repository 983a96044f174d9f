#include "ros/messages/ros_options.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <string>
#include <utility>
#include <vector>

namespace troupe::ros {
namespace {

class RosEnvironment : public testing::Test {
 protected:
  void SetUp() override { Clear(); }
  void TearDown() override { Clear(); }
  void Clear() {
    for (const char* name : {"ROS_DOMAIN_ID", "ROS_DISTRO", "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE",
                             "ROS_STATIC_PEERS", "ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY",
                             "ROS_SECURITY_KEYSTORE", "ROS_SECURITY_ENCLAVE_OVERRIDE", "RMW_IMPLEMENTATION"}) {
      unsetenv(name);
    }
  }
};

TEST_F(RosEnvironment, GivesTheDefaultsOfRos) {
  EXPECT_EQ(OptionsFromEnvironment().network.domain, 0u);
  EXPECT_EQ(OptionsFromEnvironment().network.distribution, Distribution::kJazzy);
  EXPECT_EQ(OptionsFromEnvironment().network.network_interface, "auto");
  EXPECT_EQ(OptionsFromEnvironment().network.discovery, DiscoveryRange::kSubnet);
}

TEST_F(RosEnvironment, SetsTheOptions) {
  setenv("ROS_DOMAIN_ID", "17", 1);
  setenv("ROS_DISTRO", "humble", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.domain, 17u);
  EXPECT_EQ(OptionsFromEnvironment().network.distribution, Distribution::kHumble);
  setenv("ROS_DISTRO", "lyrical", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.distribution, Distribution::kLyrical);
}

TEST_F(RosEnvironment, SetsTheRangeOfDiscovery) {
  const std::pair<const char*, DiscoveryRange> ranges[] = {
      {"OFF", DiscoveryRange::kOff},
      {"LOCALHOST", DiscoveryRange::kLocalhost},
      {"SUBNET", DiscoveryRange::kSubnet},
      {"SYSTEM_DEFAULT", DiscoveryRange::kSystemDefault},
      {"ELSEWHERE", DiscoveryRange::kLocalhost},  // as in ROS
  };
  setenv("ROS_STATIC_PEERS", "one;;10.0.0.2", 1);
  for (const auto& [name, range] : ranges) {
    setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", name, 1);
    EXPECT_EQ(OptionsFromEnvironment().network.discovery, range) << name;
  }
  EXPECT_EQ(OptionsFromEnvironment().network.static_peers, (std::vector<std::string>{"one", "10.0.0.2"}));
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET", 1);
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.discovery, DiscoveryRange::kSubnet);
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.discovery, DiscoveryRange::kLocalhost);
  EXPECT_TRUE(OptionsFromEnvironment().network.static_peers.empty());
}

TEST_F(RosEnvironment, NamesValuesThatAreNotValid) {
  for (const std::string domain : {"x", "17x", "-1", "231", "99999999999", "0x", "08"}) {
    setenv("ROS_DOMAIN_ID", domain.c_str(), 1);
    EXPECT_EQ(OptionsFromEnvironment().faults.domain,
              "ROS_DOMAIN_ID: found '" + domain + "', expected a number from 0 to 230");
  }
  setenv("ROS_DISTRO", "noetic", 1);
  EXPECT_EQ(OptionsFromEnvironment().faults.distribution,
            "ROS_DISTRO: found 'noetic', expected humble, iron, jazzy, kilted, lyrical or rolling (--ros-distro "
            "overrides it)");
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCAL", 1);
  EXPECT_NE(OptionsFromEnvironment().faults.discovery, "");
}

TEST_F(RosEnvironment, NamesAnRmwWhoseProgramsDoNotFindTheRun) {
  for (const char* rmw : {"", "rmw_cyclonedds_cpp", "rmw_fastrtps_cpp", "rmw_fastrtps_dynamic_cpp"}) {
    setenv("RMW_IMPLEMENTATION", rmw, 1);
    EXPECT_EQ(OptionsFromEnvironment().faults.rmw, "") << rmw;
  }
  setenv("RMW_IMPLEMENTATION", "rmw_zenoh_cpp", 1);
  EXPECT_EQ(OptionsFromEnvironment().faults.rmw,
            "RMW_IMPLEMENTATION: found 'rmw_zenoh_cpp', expected rmw_cyclonedds_cpp or rmw_fastrtps_cpp: programs on "
            "another one do not find this run");
}

TEST_F(RosEnvironment, ReadsADomainAsRosDoes) {
  for (const auto& [text, domain] : {std::pair{"", 0U}, {"0", 0U}, {"230", 230U}, {"0x11", 17U}, {"021", 17U}}) {
    setenv("ROS_DOMAIN_ID", text, 1);
    EXPECT_EQ(OptionsFromEnvironment().network.domain, domain) << text;
    EXPECT_EQ(OptionsFromEnvironment().faults.domain, "") << text;
  }
}

TEST_F(RosEnvironment, HasNoSecurityUnlessItIsEnabled) {
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kOff);
  setenv("ROS_SECURITY_STRATEGY", "Enforce", 1);
  setenv("ROS_SECURITY_ENABLE", "false", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kOff);
  EXPECT_EQ(OptionsFromEnvironment().network.security.fault, "");
  const Result<Enclave> none = FindEnclave(OptionsFromEnvironment().network.security, "/world");
  ASSERT_TRUE(none.ok());
  EXPECT_EQ(none.value().name, "/");
  EXPECT_EQ(none.value().folder, "");
}

TEST_F(RosEnvironment, SetsTheSecurity) {
  setenv("ROS_SECURITY_ENABLE", "true", 1);
  setenv("ROS_SECURITY_KEYSTORE", "/keys", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kPermissive);
  EXPECT_EQ(OptionsFromEnvironment().network.security.keystore, "/keys");
  setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", "/swarm", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.enclave, "/swarm");
  EXPECT_EQ(FindEnclave(OptionsFromEnvironment().network.security, "/r0").value().name, "/swarm");
  setenv("ROS_SECURITY_STRATEGY", "Permissive", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kPermissive);
  setenv("ROS_SECURITY_STRATEGY", "Enforce", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kEnforce);
}

TEST(RosNetwork, FastDdsServesNeitherSecuredRunsNorHiddenOnes) {
  RosNetwork network;
  EXPECT_EQ(UsesFastDds(network), HasFastDds());
  network.service_clients = ServiceClients::kCyclone;
  EXPECT_FALSE(UsesFastDds(network));
  network.service_clients = ServiceClients::kBoth;
  EXPECT_EQ(UsesFastDds(network), HasFastDds());
  network.discovery = DiscoveryRange::kOff;
  EXPECT_FALSE(UsesFastDds(network));
  network.discovery = DiscoveryRange::kSubnet;
  network.security.strategy = SecurityStrategy::kPermissive;
  EXPECT_FALSE(UsesFastDds(network));
}

TEST_F(RosEnvironment, ABadValueOfSecurityIsAnError) {
  setenv("ROS_SECURITY_ENABLE", "yes", 1);
  EXPECT_EQ(FindEnclave(OptionsFromEnvironment().network.security, "/world").error().message,
            "ROS_SECURITY_ENABLE: found 'yes', expected true or false");
  setenv("ROS_SECURITY_ENABLE", "true", 1);
  setenv("ROS_SECURITY_STRATEGY", "enforce", 1);
  EXPECT_EQ(FindEnclave(OptionsFromEnvironment().network.security, "/world").error().message,
            "ROS_SECURITY_STRATEGY: found 'enforce', expected Enforce or Permissive");
}

TEST_F(RosEnvironment, MissingKeysAreAnErrorOrAWarning) {
  RosSecurity security{SecurityStrategy::kEnforce, "/no/such/folder", {}, {}};
  EXPECT_EQ(
      FindEnclave(security, "/r0").error().ToString(),
      "/no/such/folder/enclaves/r0: error: found no such folder, expected the keys of a participant (enclave /r0 of "
      "ROS 2)");
  security.strategy = SecurityStrategy::kPermissive;
  const Result<Enclave> open = FindEnclave(security, "/r0");
  ASSERT_TRUE(open.ok());
  EXPECT_EQ(open.value().folder, "");
  EXPECT_NE(open.value().warning.find("continuing without security"), std::string::npos);
  security.keystore.clear();
  EXPECT_NE(FindEnclave(security, "/r0").value().warning.find("ROS_SECURITY_KEYSTORE"), std::string::npos);
}

}  // namespace
}  // namespace troupe::ros
