#include "ros/messages/robot_list.h"

#include <algorithm>
#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/json_integer.h"
#include "ros/messages/robot_in_ros.h"

namespace troupe::ros {
namespace {

using Json = nlohmann::json;

}  // namespace

bool RobotList::HasService(const std::string& service) const {
  const std::string name = "/" + service;
  return std::any_of(namespaces.begin(), namespaces.end(), [&name](const std::string& space) {
    return name.starts_with(space.ends_with("/") ? space : space + "/");
  });
}

RobotList RobotListOf(const WorldDescription& world, const RosOptions& options) {
  RobotList list;
  for (const auto& [id, robot] : FindRobotsInRos(world, options)) {
    if (robot.alone) {
      list.domains.insert(robot.domain);
    } else {
      list.namespaces.insert(robot.node_namespace);
    }
  }
  return list;
}

std::string ToText(const RobotList& list) {
  return Json{{"namespaces", list.namespaces}, {"domains", list.domains}}.dump();
}

std::optional<RobotList> ParseRobotList(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    RobotList list;
    for (const Json& name : json.at("namespaces")) list.namespaces.insert(name.get<std::string>());
    for (const Json& number : json.at("domains")) {
      const auto domain = IntegerOf<std::uint32_t>(number);
      if (domain > kLastRosDomain) return std::nullopt;
      list.domains.insert(domain);
    }
    return list;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace troupe::ros
