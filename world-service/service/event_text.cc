#include "world-service/service/event_text.h"

namespace troupe {

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
    default:
      text += robot + " " + ToString(event.type);
      if (event.other) text += " " + world.model(*event.other).name;
      break;
  }
  if (!event.detail.empty()) text += " (" + event.detail + ")";
  return text;
}

}  // namespace troupe
