// ROS domains on the loopback interface.
// The loopback interface keeps tests from robots and tools on the network of the machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ros/messages/ros_options.h"
#include "tests/support/dds_domain.h"

namespace troupe::test {

// The domains of tests in a network of their own.
inline constexpr std::uint32_t kFirstDomain = 1;  // of robots that each have a domain
inline constexpr std::uint32_t kRunDomain = 90;
inline constexpr std::uint32_t kSimulationDomain = 95;

inline ros::RosNetwork InDomain(std::uint32_t domain) {
  ros::RosNetwork network;
  network.domain = domain;
  network.network_interface = "lo";
  return network;
}

// The domain that only this test process uses, for clients of services on Cyclone DDS.
inline ros::RosNetwork TestRosNetwork() {
  static const std::uint32_t domain = ReserveDomain();
  ros::RosNetwork network = InDomain(domain);
  network.service_clients = ros::ServiceClients::kCyclone;
  return network;
}
// For a run in that domain.
inline std::vector<std::string> RosArguments(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"--ros", "--ros-interface", "lo", "--ros-domain",
                                        std::to_string(TestRosNetwork().domain)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace troupe::test
