// WorldGateway: shows a run to another system, as ROS 2 does (world-service/ros).
#pragma once

#include <functional>
#include <memory>

#include "common/protocol/messages.h"
#include "common/spatial/scene.h"
#include "world-service/service/world_control.h"

namespace troupe {

class WorldGateway {
 public:
  virtual ~WorldGateway() = default;
  // Called once for each tick, after the agents were sent the frame. Must be quick, and wait for nobody.
  virtual void Publish(const FrameMessage& frame) = 0;
  // The world is another one from the next frame on, after an edit. Called like Publish.
  virtual void ChangeWorld(std::shared_ptr<const Scene> scene) { (void)scene; }
  // Gives the control over the run, and takes it back by null: none is in use any more when that returns.
  virtual void Connect(WorldControl* control) { (void)control; }
};

// Throws std::exception if it cannot. The scene outlives the gateway.
using MakeWorldGateway = std::function<std::unique_ptr<WorldGateway>(const Scene& scene)>;

}  // namespace troupe
