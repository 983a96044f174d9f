#include "common/model/drive_limits.h"

#include <algorithm>
#include <cmath>

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

double ClampComponent(const Interval& velocity, const Interval& acceleration, double current, double desired,
                      double seconds) {
  const Interval reachable{current + acceleration.min * seconds, current + acceleration.max * seconds};
  return reachable.Clamp(velocity.Clamp(desired));
}

struct CarMotion {
  double speed = 0.0;     // m/s, of the steered wheel
  double steering = 0.0;  // rad, at most a quarter turn to either side
};

// The inverse of CarTwist.
CarMotion ToCarMotion(const Twist& twist, double wheelbase) {
  const double sideways = twist.wz * wheelbase;
  const double speed = std::sqrt(twist.vx * twist.vx + sideways * sideways);
  if (twist.vx < 0.0) return {-speed, Atan2(-sideways, -twist.vx)};
  return {speed, Atan2(sideways, twist.vx)};
}

bool IsNear(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max({1.0, std::abs(a), std::abs(b)});
}

}  // namespace

Twist ClampToLimits(const DriveDescription& drive, const Twist& current, const Twist& desired, double seconds) {
  const TwistBounds& v = drive.velocity;
  const TwistBounds& a = drive.acceleration;
  if (drive.type == DriveType::kCar) {
    const CarMotion now = ToCarMotion(current, drive.wheelbase);
    const CarMotion then = ToCarMotion(desired, drive.wheelbase);
    // The twist of a car at rest has no steering angle, so the rate of steering has no bound.
    return CarTwist(ClampComponent(v.x, a.x, now.speed, then.speed, seconds), v.heading.Clamp(then.steering),
                    drive.wheelbase);
  }
  Twist result;
  result.vx = ClampComponent(v.x, a.x, current.vx, desired.vx, seconds);
  if (drive.type == DriveType::kOmni) result.vy = ClampComponent(v.y, a.y, current.vy, desired.vy, seconds);
  result.wz = ClampComponent(v.heading, a.heading, current.wz, desired.wz, seconds);
  return result;
}

bool WithinLimits(const DriveDescription& drive, const Twist& current, const Twist& proposed, double seconds) {
  const Twist clamped = ClampToLimits(drive, current, proposed, seconds);
  return IsNear(clamped.vx, proposed.vx) && IsNear(clamped.vy, proposed.vy) && IsNear(clamped.wz, proposed.wz);
}

Twist CarTwist(double speed, double steering, double wheelbase) {
  const SinCosResult trig = SinCos(steering);
  return {.vx = speed * trig.cos, .vy = 0.0, .wz = speed * trig.sin / wheelbase};
}

}  // namespace troupe
