#include "world-service/service/event_json.h"

#include <nlohmann/json.hpp>

namespace troupe {

nlohmann::json EventJson(const WorldDescription& world, const Event& event) {
  nlohmann::json json = {{"event", ToString(event.type)}};
  if (event.robot) json["robot"] = world.robot(*event.robot).name;
  if (event.object) json["object"] = world.model(*event.object).name;
  if (event.other) json["other"] = world.model(*event.other).name;
  return json;
}

}  // namespace troupe
