// NodeProbe: asks a node of ROS 2 for the values of no parameters, to learn that it receives what this participant
// writes. A node answers once it spins: it has then made the readers that it makes at its start. And its DDS learns of
// the endpoints of this participant in the sequence of their making: it knows of all that were made before the probe.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "ros/connection/ros_participant.h"
#include "ros/connection/topic_types.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"

namespace troupe::ros {

class NodeProbe {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // `service`: "/driver/get_parameters", of a node on Cyclone DDS. Throws dds::Exception. The participant must outlive
  // this.
  NodeProbe(const RosParticipant& participant, const std::string& service);

  // Asks as soon as the service is known, and again each second. When the node has answered.
  std::optional<Time> Poll(Time now);

 private:
  using Request = rcl_interfaces_srv_dds__GetParameters_Request_;
  using Response = rcl_interfaces_srv_dds__GetParameters_Response_;

  const std::uint64_t id_;  // all clients of a service get all responses
  dds::Topic<Request> request_topic_;
  dds::Topic<Response> response_topic_;
  dds::DataWriter<Request> writer_;
  dds::DataReader<Response> reader_;
  std::int64_t questions_ = 0;
  std::optional<Time> asked_at_;
  std::optional<Time> answered_at_;
};

}  // namespace troupe::ros
