// A ROS domain that only this test process uses, on the loopback interface.
#pragma once

#include "ros/messages/ros_options.h"
#include "tests/support/reserved_domain.h"

namespace troupe::test {

// For clients of services on Cyclone DDS.
inline ros::RosNetwork TestRosNetwork() {
  ros::RosNetwork network;
  static const std::uint32_t domain = ReserveDomain();
  network.domain = domain;
  network.network_interface = "lo";
  network.service_clients = ros::ServiceClients::kCyclone;
  return network;
}

}  // namespace troupe::test
