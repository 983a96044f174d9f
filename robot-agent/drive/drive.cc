#include "robot-agent/drive/drive.h"

#include <cmath>

#include "common/model/device_limits.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

// A controller of a user may divide by zero: the robot stops in that component, and the run goes on.
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

void Odometry::Update(const Pose& X_WR) {
  if (localization_->type == LocalizationType::kGps) {
    estimate_ = X_WR;
    return;
  }
  if (!started_) {
    started_ = true;
    estimate_ = localization_->origin;
  } else if (!(X_WR == last_X_WR_)) {
    Pose motion = Inverse(last_X_WR_) * X_WR;  // executed, not commanded: a stalled robot counts no motion
    motion.x *= 1.0 + localization_->error_x;
    motion.y *= 1.0 + localization_->error_y;
    motion.heading = WrapAngle(motion.heading * (1.0 + localization_->error_heading));
    estimate_ = estimate_ * motion;
  }
  last_X_WR_ = X_WR;
}

}  // namespace troupe
