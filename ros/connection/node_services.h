// ParameterServices: the six parameter services of a node, for `ros2 param`. Parameters are read-only: they state how
// the run was started, and a run whose settings changed from outside could not be repeated.
//
// All six exist or none: the tools wait until all six of a node have been discovered. Answers are made on a thread of
// the connection from values that never change, without a lock.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <variant>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_participant.h"
#include "ros/connection/topic_types.h"

namespace troupe::ros {

using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;
using Parameters = std::map<std::string, ParameterValue>;  // by name

class ParameterServices {
 public:
  // `name`: of the node in the service names, as in /anna/robot/list_parameters.
  ParameterServices(const RosNode& node, const std::string& name, Parameters parameters);
  ~ParameterServices();

 private:
  struct Services;
  std::unique_ptr<Services> services_;
};

// TypeDescriptionService: the service ~/get_type_description of a node, from Jazzy on: the fields of the types of its
// topics and services, for tools that have no package with these types.
class TypeDescriptionService {
 public:
  // Without effect before Jazzy. `name`: of the node in the service name, as in ParameterServices.
  TypeDescriptionService(const RosNode& node, const std::string& name);

 private:
  using Request = type_description_interfaces_srv_dds__GetTypeDescription_Request_;
  using Response = type_description_interfaces_srv_dds__GetTypeDescription_Response_;

  void Describe(const RosCaller& caller, const Request& request);

  std::unique_ptr<RosService<Request, Response>> service_;  // may be null
};

}  // namespace troupe::ros
