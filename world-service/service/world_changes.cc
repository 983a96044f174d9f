#include "world-service/service/world_changes.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace troupe {

using Json = nlohmann::json;

WorldDescription WorldChanges::AppliedTo(WorldDescription world) const {
  if (seed) world.seed = *seed;
  for (RobotDescription& robot : world.robots) {
    const auto changed = controllers.find(robot.name);
    if (changed != controllers.end()) robot.controller = changed->second;
  }
  return world;
}

std::string WorldChanges::ToText() const {
  Json text = Json::object();
  if (seed) text["seed"] = *seed;
  for (const auto& [robot, controller] : controllers) {
    text["controllers"][robot] = {{"name", controller.name}, {"parameters", controller.parameters}};
  }
  return text.dump();
}

Result<WorldChanges> WorldChanges::FromText(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  const Error malformed{{}, "found changes that are not a JSON object with a seed and controllers"};
  if (!json.is_object()) return malformed;
  WorldChanges changes;
  for (const auto& [key, value] : json.items()) {
    if (key == "seed" && value.is_number_unsigned()) {
      changes.seed = value.get<std::uint64_t>();
    } else if (key == "controllers" && value.is_object()) {
      for (const auto& [robot, controller] : value.items()) {
        if (!controller.is_object() || !controller.contains("name") || !controller["name"].is_string() ||
            !controller.contains("parameters") || !controller["parameters"].is_string()) {
          return malformed;
        }
        changes.controllers[robot] = {controller["name"].get<std::string>(),
                                      controller["parameters"].get<std::string>()};
      }
    } else {
      return malformed;
    }
  }
  return changes;
}

}  // namespace troupe
