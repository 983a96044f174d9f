#include "common/model/event.h"

namespace troupe {

const char* ToString(EventType type) {
  switch (type) {
    case EventType::kStallBegan:
      return "stall_began";
    case EventType::kStallEnded:
      return "stall_ended";
    case EventType::kJoined:
      return "joined";
    case EventType::kLeft:
      return "left";
    case EventType::kProposalRejected:
      return "proposal_rejected";
  }
  return "unknown";
}

}  // namespace troupe
