// The messages to the page that are JSON: the session, the status and the timeline. Replies are in page_request.h.
//
// They are made once for all viewers and compared by pointer: a viewer has the newest if it has the same pointer.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/timeline/timeline.h"
#include "transport/protocol/messages.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe {

// The facts about a session that the page gets beside the options of the gateway.
// `problem`: why the run cannot be observed; empty: it is, or is not wanted.
struct SessionFacts {
  bool connected = false;
  bool recording = false;
  bool runs_again = false;
  bool saves_recording = false;
  std::string problem = {};
};
std::string SessionText(const ViewerGatewayOptions& options, const SessionFacts& facts);

// The fields of the status, and `waiting_count`, because it names only some robots. Null: there is none.
std::shared_ptr<const std::string> StatusText(std::optional<StatusMessage> status);

// The spans of the past: those that are new tell more than the page knows by the ends of the timeline in each update.
std::shared_ptr<const std::string> TimelineText(const std::vector<TimeSpan>& spans);

}  // namespace troupe
