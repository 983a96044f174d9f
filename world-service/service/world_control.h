// WorldControl: pausing, playing and stepping a run from outside, by a tool (troupe ctl) or a gateway (ROS 2 services).
#pragma once

#include <functional>

#include "common/protocol/messages.h"

namespace troupe {

// Gets the answer to a request, once: from inside the request or later, on any thread. Must be quick.
using ControlReplyTo = std::function<void(const ControlReply&)>;

class WorldControl {
 public:
  virtual ~WorldControl() = default;
  virtual void Request(const ControlRequest& request, ControlReplyTo reply) = 0;
  // The newest frame.
  virtual FrameMessage CurrentFrame() = 0;
};

}  // namespace troupe
