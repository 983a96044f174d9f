// The texts of a Link that describe nodes and endpoints: JSON.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ros/connection/ros_connection.h"
#include "troupe/result.h"

namespace troupe::ros {

// The first text of an agent.
struct HelloText {
  std::string version;
  std::uint32_t domain = 0;  // of its nodes and endpoints
};

struct NodeText {
  std::string node_namespace;
  std::string name;
};

// Of a writer, a reader or a service.
struct EndpointText {
  std::uint32_t node = 0;
  std::string name;           // of the topic on DDS, or of the service
  std::string type;           // its name on DDS; of requests
  std::string response_type;  // of a service
  TopicQos qos;
  Part part = Part::kOnlyReader;  // of a reader
};

// Of a service that Fast DDS serves.
struct ServiceText {
  std::uint32_t domain = 0;
  std::string name;  // "/anna/robot/get_parameters"
  std::string request_type;
  std::string response_type;
};

std::string ToText(const HelloText& hello);
std::string ToText(const NodeText& node);
std::string ToText(const EndpointText& endpoint);
std::string ToText(const ServiceText& service);
// Any text is safe.
Result<HelloText> ParseHello(std::string_view text);
Result<NodeText> ParseNode(std::string_view text);
Result<EndpointText> ParseEndpoint(std::string_view text);
Result<ServiceText> ParseService(std::string_view text);

}  // namespace troupe::ros
