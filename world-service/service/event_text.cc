#include "world-service/service/event_text.h"

#include <nlohmann/json.hpp>

#include "common/base/json_text.h"

namespace troupe {
namespace {

// The name of a model; without one, of the ground.
std::string Name(const WorldDescription& world, const std::optional<ModelId>& model) {
  return model ? world.model(*model).name : "the ground";
}

}  // namespace

std::string EventText(const WorldDescription& world, const Event& event) {
  const std::string robot = event.robot ? world.robot(*event.robot).name : "";
  std::string text = "tick " + std::to_string(event.tick) + ": ";
  switch (event.type) {
    case EventType::kStallBegan:
      text += robot + " stalled";
      if (event.other) text += " at " + world.model(*event.other).name;
      break;
    case EventType::kStallEnded:
      text += robot + " moves freely again";
      break;
    case EventType::kJoined:
      text += robot + " has an agent";
      break;
    case EventType::kLeft:
      text += robot + " has lost its agent";
      break;
    case EventType::kProposalRejected:
      text += "proposal rejected";
      if (event.robot) text += " for " + robot;
      break;
    case EventType::kBlocked:
      text += robot + " is blocked by " + Name(world, event.other);
      break;
    case EventType::kGripped:
      text += robot + " holds " + Name(world, event.object);
      break;
    case EventType::kReleased:
      text += robot + " released " + Name(world, event.object);
      break;
    case EventType::kLanded:
      text += Name(world, event.object) + " landed on " + Name(world, event.other);
      break;
    case EventType::kUnstable:
      text += Name(world, event.object) + " landed out of balance on " + Name(world, event.other);
      break;
    case EventType::kOutOfEnergy:
      text += robot + " has no energy";
      break;
    case EventType::kSaid:
      return text + robot + " says: " + event.detail;
  }
  if (!event.detail.empty()) text += " (" + event.detail + ")";
  return text;
}

nlohmann::json EventJson(const WorldDescription& world, const Event& event) {
  nlohmann::json json = {{"event", ToString(event.type)}};
  if (event.robot) json["robot"] = world.robot(*event.robot).name;
  if (event.object) json["object"] = world.model(*event.object).name;
  if (event.other) json["other"] = world.model(*event.other).name;
  return json;
}

std::string EventLine(const WorldDescription& world, const Event& event) {
  nlohmann::json json = EventJson(world, event);
  json["tick"] = event.tick;
  json["detail"] = event.detail;
  return JsonText(json);
}

}  // namespace troupe
