// Gateway: connects an agent's robots to another system, as ROS 2 does (robot-agent/ros): what they measure goes out,
// and commands come in. It never changes a result unless it gives a command.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/model/world_state.h"
#include "common/spatial/scene.h"
#include "robot-agent/agent/outside_command.h"

namespace troupe {

// One robot at one tick.
class RobotView {
 public:
  virtual ~RobotView() = default;
  virtual RobotId id() const = 0;
  virtual const RobotState& state() const = 0;
  virtual const WorldState& world_state() const = 0;
  virtual const Pose& pose_estimate() const = 0;  // by the robot's localization, as in Observation
  // What a ranger measures now; measured at this call unless the robot's controller has looked already. Valid until the
  // next call.
  virtual const RangerReading& Measure(std::size_t ranger) const = 0;
};

class Gateway {
 public:
  virtual ~Gateway() = default;

  // What comes from outside for the tick after `tick`. Called once for each robot and tick, before the agent's answer
  // goes out, so it must be quick.
  virtual OutsideCommand CommandFor(RobotId robot, Tick tick) = 0;

  // Publishes a tick; called after the agent's answer to it went out. Must not wait for anybody.
  virtual void Publish(Tick tick, std::span<const RobotView* const> robots) = 0;

  // The robots begin anew, perhaps at an earlier tick: what was commanded before does not count.
  virtual void Restart() {}

  // What there is to tell people since the last call.
  virtual std::vector<std::string> TakeReports() = 0;
};

// Makes the gateway of an agent that takes up `robots`; throws std::exception if it cannot.
using MakeGateway = std::function<std::unique_ptr<Gateway>(const Scene& scene, const std::vector<RobotId>& robots)>;

}  // namespace troupe
