#include "robot-agent/ros/twist_command.h"

#include <cmath>

#include "common/base/deterministic_math.h"

namespace troupe {

std::optional<Command> CommandFromTwist(const ros::TwistMessage& twist, const DriveDescription& drive) {
  const Twist wanted{twist.linear.x, twist.linear.y, twist.angular.z};
  if (!IsFinite(wanted)) return std::nullopt;
  Command command;
  if (drive.type != DriveType::kCar) {
    command.twist = wanted;
    return command;
  }
  if (wanted.vx == 0.0) return command;
  // vx = speed cos(steering), wz = speed sin(steering) / wheelbase.
  const double sideways = wanted.wz * drive.wheelbase;
  const double direction = wanted.vx < 0.0 ? -1.0 : 1.0;
  command.speed = direction * std::sqrt(wanted.vx * wanted.vx + sideways * sideways);
  command.steering = Atan2(direction * sideways, direction * wanted.vx);
  return command;
}

}  // namespace troupe
