// TypeDescriptionService: the service ~/get_type_description of a node, from Jazzy on: the fields of the types of its
// topics and services, for tools that have no package with these types.
#pragma once

#include <string>

#include "ros/connection/ros_service.h"
#include "ros/connection/topic_types.h"

namespace troupe::ros {

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
