// ViewerState: the messages that one viewer has received, and those that it is to receive.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "viewer/gateway/foxglove_client.h"
#include "viewer/gateway/page_request.h"
#include "viewer/gateway/past_state.h"

namespace troupe {

struct ViewerState {
  // Replies that wait for a viewer; a viewer with more of them does not read, and is not answered any more.
  static constexpr std::size_t kMostTexts = 64;

  SelectRequest selected;
  std::deque<std::string> texts;
  std::uint32_t world = 0;                                   // number of the world that it has; 0: none
  std::uint64_t update = 0;                                  // of that world that it has received last; 0: none
  std::uint64_t event = 0;                                   // number of the last event
  bool selection_new = false;                                // since the last update
  bool readings_missing = false;                             // the last update left out some of the selection
  std::chrono::steady_clock::time_point next_pictures = {};  // camera images are not sent earlier
  std::unique_ptr<FoxgloveClient> foxglove;                  // null: the page
  bool in_past = false;                                      // it shows, or waits for, a past state
  std::shared_ptr<const PastState> past;                     // null: not found yet
  bool past_new = false;                                     // it was not sent yet
  bool knows_session = false;                                // the session message was sent, as it is now
};

}  // namespace troupe
