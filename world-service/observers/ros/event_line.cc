#include "world-service/observers/ros/event_line.h"

#include <nlohmann/json.hpp>

#include "common/base/json_text.h"
#include "world-service/service/event_text.h"

namespace troupe {

std::string EventLine(const WorldDescription& world, const Event& event) {
  nlohmann::json json = EventJson(world, event);
  json["tick"] = event.tick;
  json["detail"] = event.detail;
  return JsonText(json);
}

}  // namespace troupe
