// WorldControl: pausing, playing and stepping a run and editing its world from outside, by a tool (troupe ctl) or a
// gateway (ROS 2 services).
#pragma once

#include <functional>

#include "transport/protocol/messages.h"

namespace troupe {

// Receives the reply to a request, once: from inside the request or later, on any thread. Must be quick; it may make
// another request.
using ControlReplyTo = std::function<void(const ControlReply&)>;

class WorldControl {
 public:
  virtual ~WorldControl() = default;
  virtual void Request(const ControlRequest& request, ControlReplyTo reply) = 0;
};

}  // namespace troupe
