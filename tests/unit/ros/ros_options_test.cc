#include "common/ros/ros_options.h"

#include <gtest/gtest.h>
#include <stdlib.h>

namespace troupe::ros {
namespace {

class RosEnvironment : public testing::Test {
 protected:
  void SetUp() override { Clear(); }
  void TearDown() override { Clear(); }
  void Clear() {
    for (const char* name : {"ROS_DOMAIN_ID", "ROS_DISTRO", "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE"}) {
      unsetenv(name);
    }
  }
};

TEST_F(RosEnvironment, GivesTheDefaultsOfRos) {
  EXPECT_EQ(OptionsFromEnvironment().domain, 0u);
  EXPECT_EQ(OptionsFromEnvironment().distribution, Distribution::kJazzy);
  EXPECT_EQ(OptionsFromEnvironment().network_interface, "auto");
}

TEST_F(RosEnvironment, SetsTheOptions) {
  setenv("ROS_DOMAIN_ID", "17", 1);
  setenv("ROS_DISTRO", "humble", 1);
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  EXPECT_EQ(OptionsFromEnvironment().domain, 17u);
  EXPECT_EQ(OptionsFromEnvironment().distribution, Distribution::kHumble);
  EXPECT_EQ(OptionsFromEnvironment().network_interface, "lo");
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1);
  EXPECT_EQ(OptionsFromEnvironment().network_interface, "lo");
}

TEST_F(RosEnvironment, IsIgnoredWhereItIsNotValid) {
  for (const char* domain : {"", "x", "17x", "-1", "231", "99999999999"}) {
    setenv("ROS_DOMAIN_ID", domain, 1);
    EXPECT_EQ(OptionsFromEnvironment().domain, 0u) << domain;
  }
  setenv("ROS_DISTRO", "noetic", 1);
  EXPECT_EQ(OptionsFromEnvironment().distribution, Distribution::kJazzy);
}

}  // namespace
}  // namespace troupe::ros
