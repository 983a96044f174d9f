#include "troupe/pose.h"

#include <cmath>

namespace troupe {

Pose operator*(const Pose& X_AB, const Pose& X_BC) {
  const Vec2 p = Transform2(X_AB) * X_BC.translation();
  return {p.x(), p.y(), X_AB.z + X_BC.z, WrapAngle(X_AB.heading + X_BC.heading)};
}

Pose Inverse(const Pose& X_AB) {
  const Vec2 p = Transform2(X_AB).InverseRotate(-X_AB.translation());
  return {p.x(), p.y(), -X_AB.z, WrapAngle(-X_AB.heading)};
}

Transform2::Transform2(const Pose& X_AB) : p_(X_AB.x, X_AB.y) {
  // Most models have no heading: they keep cos 1 and sin 0 exactly.
  if (X_AB.heading != 0.0) {
    const SinCosResult trig = SinCos(X_AB.heading);
    cos_ = trig.cos;
    sin_ = trig.sin;
  }
}

Pose Integrate(const Twist& twist, double seconds) {
  const double angle = twist.wz * seconds;
  double a;  // sin(angle) / angle
  double b;  // (1 - cos(angle)) / angle
  if (std::abs(angle) < 1e-4) {
    // Taylor: the next terms are below the last bit.
    a = 1.0 - angle * angle / 6.0;
    b = 0.5 * angle - angle * angle * angle / 24.0;
  } else {
    const SinCosResult trig = SinCos(angle);
    a = trig.sin / angle;
    b = (1.0 - trig.cos) / angle;
  }
  const double dx = twist.vx * seconds;
  const double dy = twist.vy * seconds;
  return {a * dx - b * dy, b * dx + a * dy, 0.0, WrapAngle(angle)};
}

}  // namespace troupe
