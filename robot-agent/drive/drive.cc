#include "robot-agent/drive/drive.h"

#include <cmath>

#include "common/model/drive_limits.h"

namespace troupe {
namespace {

double FiniteOrZero(double value) {
  return std::isfinite(value) ? value : 0.0;
}

Twist DesiredTwist(const DriveDescription& drive, const Command& command) {
  switch (drive.type) {
    case DriveType::kDifferential:
      return {FiniteOrZero(command.twist.vx), 0.0, FiniteOrZero(command.twist.wz)};
    case DriveType::kOmni:
      return {FiniteOrZero(command.twist.vx), FiniteOrZero(command.twist.vy), FiniteOrZero(command.twist.wz)};
    case DriveType::kCar:
      // Bounded before the conversion to a twist: a steering angle beyond its bound must not change the speed.
      return CarTwist(drive.velocity.x.Clamp(FiniteOrZero(command.speed)),
                      drive.velocity.heading.Clamp(FiniteOrZero(command.steering)), drive.wheelbase);
  }
  return {};
}

}  // namespace

Twist DriveTowards(const DriveDescription& drive, const Twist& current, const Command& command, double seconds) {
  return ClampToLimits(drive, current, DesiredTwist(drive, command), seconds);
}

}  // namespace troupe
