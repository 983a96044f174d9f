#include "robot-agent/drive/twist_command.h"

#include <cmath>

#include "troupe/deterministic_math.h"

namespace troupe {

Command CommandFromTwist(const Twist& wanted, const DriveDescription& drive) {
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
