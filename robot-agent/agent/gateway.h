// Gateway: connects the robots of an agent to another system, for instance ROS 2 (robot-agent/ros): it publishes states
// and readings, and receives commands.
//
// A command of a gateway is an input of its tick, like one of a tool; apart from commands a gateway changes no result:
// it may publish, drop or delay as it likes. All functions are called on one thread at a time, in a tick first
// CommandFor for each robot, then Publish. CommandFor is on the way of the tick, and Publish comes after the answer was
// sent: an agent that publishes slowly delays its next answer, not this one.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "robot-agent/robot/robot.h"
#include "troupe/world_state.h"

namespace troupe {

// One robot at one tick.
class RobotView {
 public:
  virtual ~RobotView() = default;
  virtual RobotId id() const = 0;
  virtual const RobotState& state() const = 0;
  virtual const WorldState& world_state() const = 0;
  virtual const Pose& pose_estimate() const = 0;  // by the robot's localization, as in Observation
  // The reading of a sensor, by its index in RobotInfo::sensors, at this tick; measured by this call unless the robot's
  // controller has read it. Valid until the next call.
  virtual const SensorReading& Measure(std::size_t sensor) const = 0;
};

class Gateway {
 public:
  virtual ~Gateway() = default;

  // The external command for the tick after `state`. Called once for each robot and tick, before the agent's answer is
  // sent: the call delays the tick.
  virtual ExternalCommand CommandFor(RobotId robot, const WorldState& state) = 0;

  // Publishes a tick; called after the agent's answer to it was sent. The call must not wait for readers.
  virtual void Publish(Tick tick, std::span<const RobotView* const> robots) = 0;

  // Waits until all messages of Publish are on their way, in order: the service is told next that the tick is
  // published.
  virtual void AwaitPublished() {}

  // Called a few times a second in a pause: publishes the tick again for new readers, if any.
  virtual void Repeat(Tick, std::span<const RobotView* const>) {}

  // An edit has changed other parts of the world than these robots. REQUIRES: the scene outlives the gateway, or the
  // next call.
  virtual void ChangeWorld(const Scene&) {}

  // The robots start again, perhaps at an earlier tick: pending commands are discarded.
  virtual void Restart() {}

  // Drains the messages for the log of the run.
  virtual std::vector<std::string> DrainReports() = 0;
};

// Makes the gateway of an agent with `robots`; throws std::exception on failure.
using MakeGateway = std::function<std::unique_ptr<Gateway>(const Scene& scene, const std::vector<RobotId>& robots)>;

}  // namespace troupe
