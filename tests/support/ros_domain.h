// ROS domains on the loopback interface.
#pragma once

#include <string>
#include <vector>

#include "ros/messages/ros_options.h"
#include "tests/support/reserved_domain.h"

namespace troupe::test {

// Of tests in a network of their own.
inline constexpr std::uint32_t kFirstDomain = 1;  // of robots that each have a domain
inline constexpr std::uint32_t kRunDomain = 90;
inline constexpr std::uint32_t kSimulationDomain = 95;

inline ros::RosOptions InDomain(std::uint32_t domain) {
  ros::RosOptions options;
  options.domain = domain;
  options.network_interface = "lo";
  return options;
}

// The domain that only this test process uses.
inline ros::RosOptions TestRosOptions() {
  static const std::uint32_t domain = ReserveDomain();
  return InDomain(domain);
}
// For a run in that domain.
inline std::vector<std::string> RosArguments(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"--ros", "--ros-interface", "lo", "--ros-domain",
                                        std::to_string(TestRosOptions().domain)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace troupe::test
