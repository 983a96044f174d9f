#include "robot-agent/navigation/steer_to_point.h"

#include <algorithm>
#include <cmath>

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kTurnGain = 2.0;  // 1/s: turn rate for each radian of bearing

Command SteerCar(const DriveDescription& drive, const SteerSettings& settings, const Vec2& p_R, double speed) {
  const double square = std::max(p_R.squaredNorm(), 1e-6);
  Command command;
  if (p_R.x() > 0.0 || square > 16.0 * drive.wheelbase * drive.wheelbase) {
    command.speed = speed;
    command.steering = Atan2(2.0 * drive.wheelbase * p_R.y(), square);
    if (p_R.x() <= 0.0) command.steering = p_R.y() >= 0.0 ? 0.5 * kPi : -0.5 * kPi;  // as far as it can
  } else {
    // A point beside or behind that is too near to turn to: it backs off, turning its front to the point.
    command.speed = -0.5 * std::min(speed, settings.speed);
    command.steering = p_R.y() >= 0.0 ? -0.5 * kPi : 0.5 * kPi;
  }
  command.steering = drive.velocity.heading.Clamp(command.steering);
  return command;
}

}  // namespace

double BrakingSpeed(const DriveDescription& drive, double distance) {
  const double braking = std::max(-drive.acceleration.x.min, 1e-3);
  return std::sqrt(2.0 * braking * std::max(distance, 0.0));
}

Command SteerToPoint(const DriveDescription& drive, const SteerSettings& settings, const Vec2& p_R, double most) {
  const double speed = std::min(settings.speed, most);
  if (drive.type == DriveType::kCar) return SteerCar(drive, settings, p_R, speed);
  const double bearing = Atan2(p_R.y(), p_R.x());
  const double facing = std::max(p_R.x() / std::max(std::sqrt(p_R.squaredNorm()), 1e-9), 0.0);
  Command command;
  command.twist.vx = speed * facing * facing;
  command.twist.wz = std::clamp(kTurnGain * bearing, -settings.turn_rate, settings.turn_rate);
  return command;
}

}  // namespace troupe
