// ParameterServices: the six parameter services of a node, for `ros2 param`. Parameters are read-only: they state how
// the run was started.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <variant>

#include "ros/connection/ros_participant.h"

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

}  // namespace troupe::ros
