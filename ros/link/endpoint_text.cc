#include "ros/link/endpoint_text.h"

#include <nlohmann/json.hpp>

#include "common/base/utf8.h"

namespace troupe::ros {
namespace {

using nlohmann::json;

constexpr std::int32_t kDeepest = 1'000'000;  // samples

Error Malformed(std::string_view text) {
  return {{}, "found '" + PlainLine(text, 200) + "', expected a version, a node or an endpoint"};
}

}  // namespace

std::string ToText(const HelloText& hello) {
  return json{{"version", hello.version}, {"domain", hello.domain}}.dump();
}

std::string ToText(const NodeText& node) {
  return json{{"namespace", node.node_namespace}, {"name", node.name}}.dump();
}

std::string ToText(const EndpointText& endpoint) {
  return json{{"node", endpoint.node},
              {"name", endpoint.name},
              {"type", endpoint.type},
              {"response_type", endpoint.response_type},
              {"qos", static_cast<int>(endpoint.qos.kind)},
              {"depth", endpoint.qos.depth},
              {"part", static_cast<int>(endpoint.part)}}
      .dump();
}

std::string ToText(const ServiceText& service) {
  return json{{"domain", service.domain},
              {"name", service.name},
              {"request_type", service.request_type},
              {"response_type", service.response_type}}
      .dump();
}

Result<HelloText> ParseHello(std::string_view text) {
  try {
    const json parsed = json::parse(text);
    return HelloText{parsed.at("version").get<std::string>(), parsed.at("domain").get<std::uint32_t>()};
  } catch (const json::exception&) {
    return Malformed(text);
  }
}

Result<NodeText> ParseNode(std::string_view text) {
  try {
    const json parsed = json::parse(text);
    return NodeText{parsed.at("namespace").get<std::string>(), parsed.at("name").get<std::string>()};
  } catch (const json::exception&) {
    return Malformed(text);
  }
}

Result<EndpointText> ParseEndpoint(std::string_view text) {
  try {
    const json parsed = json::parse(text);
    const auto kind = parsed.at("qos").get<std::uint32_t>();
    const auto depth = parsed.at("depth").get<std::int64_t>();
    const auto part = parsed.at("part").get<std::uint32_t>();
    if (kind > static_cast<std::uint32_t>(TopicQos::Kind::kLogLines) || depth < 1 || depth > kDeepest ||
        part > static_cast<std::uint32_t>(Part::kBestEffortReader)) {
      return Malformed(text);
    }
    return EndpointText{parsed.at("node").get<std::uint32_t>(),
                        parsed.at("name").get<std::string>(),
                        parsed.at("type").get<std::string>(),
                        parsed.at("response_type").get<std::string>(),
                        {static_cast<TopicQos::Kind>(kind), static_cast<std::int32_t>(depth)},
                        static_cast<Part>(part)};
  } catch (const json::exception&) {
    return Malformed(text);
  }
}

Result<ServiceText> ParseService(std::string_view text) {
  try {
    const json parsed = json::parse(text);
    return ServiceText{parsed.at("domain").get<std::uint32_t>(), parsed.at("name").get<std::string>(),
                       parsed.at("request_type").get<std::string>(), parsed.at("response_type").get<std::string>()};
  } catch (const json::exception&) {
    return Malformed(text);
  }
}

}  // namespace troupe::ros
