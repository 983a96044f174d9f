// Recovery: the way out of a contact at which the manoeuvres of a controller are blocked: random motions, until one of
// them is free.
#pragma once

#include <limits>
#include <optional>

#include "robot-agent/navigation/steer_to_point.h"
#include "troupe/controller.h"

namespace troupe {

class Recovery {
 public:
  Recovery(const DriveDescription& drive, const SteerSettings& settings) : drive_(drive), settings_(settings) {}

  static constexpr double kPatience = 1.0;  // s: for robots whose own manoeuvres are blocked
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  // The command of a recovery, while there is one; it begins once the robot has not moved for `patience` s. Call it in
  // each tick: the time of ticks without a call does not count.
  std::optional<Command> Update(const Observation& observation, double patience);

 private:
  void ObserveMotion(const Observation& observation);
  Command RandomMotion(const Observation& observation) const;

  DriveDescription drive_;
  SteerSettings settings_;
  std::optional<Pose> rest_;  // the last pose from which the robot has not moved noticeably
  double rest_since_ = 0.0;   // s, simulated, as all times
  double called_at_ = 0.0;
  std::optional<Command> motion_;  // of a recovery
  double motion_until_ = 0.0;
};

}  // namespace troupe
