// The texts of a Link that describe nodes and endpoints: JSON.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ros/connection/ros_connection.h"
#include "troupe/result.h"

namespace troupe::ros {

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

std::string ToText(const NodeText& node);
std::string ToText(const EndpointText& endpoint);
// Any text is safe.
Result<NodeText> ParseNode(std::string_view text);
Result<EndpointText> ParseEndpoint(std::string_view text);

}  // namespace troupe::ros
