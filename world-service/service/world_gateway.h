// WorldGateway: shows a run to another system, as ROS 2 does (world-service/ros).
#pragma once

#include <functional>
#include <memory>

#include "common/protocol/messages.h"
#include "common/spatial/scene.h"

namespace troupe {

class WorldGateway {
 public:
  virtual ~WorldGateway() = default;
  // Called once for each tick, after the agents were sent the frame. Must be quick, and wait for nobody.
  virtual void Publish(const FrameMessage& frame) = 0;
};

// Throws std::exception if it cannot. The scene outlives the gateway.
using MakeWorldGateway = std::function<std::unique_ptr<WorldGateway>(const Scene& scene)>;

}  // namespace troupe
