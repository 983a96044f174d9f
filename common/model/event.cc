#include "troupe/event.h"

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
    case EventType::kBlocked:
      return "blocked";
    case EventType::kGripped:
      return "gripped";
    case EventType::kReleased:
      return "released";
    case EventType::kLanded:
      return "landed";
    case EventType::kUnstable:
      return "unstable";
    case EventType::kOutOfEnergy:
      return "out_of_energy";
    case EventType::kSaid:
      return "said";
  }
  return "unknown";
}

}  // namespace troupe
