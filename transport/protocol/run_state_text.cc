#include "transport/protocol/run_state_text.h"

namespace troupe {

const char* ToString(RunState state) {
  switch (state) {
    case RunState::kStarting:
      return "starting";
    case RunState::kPlaying:
      return "playing";
    case RunState::kPaused:
      return "paused";
    case RunState::kOver:
      return "over";
  }
  return "";
}

}  // namespace troupe
