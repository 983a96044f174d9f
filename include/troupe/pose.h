// Poses and twists in 2.5D: a place in the plane with a heading, at a height.
//
// X_AB is the pose of frame B in frame A: X_AC = X_AB * X_BC, p_A = X_AB * p_B. docs/conventions.md lists the frames: W
// world, M model, P parent model, R robot, S sensor, ... x forward, y left, z up; metres, radians counter-clockwise
// (REP 103).
//
// 2.5D, because robots of this simulation stand upright: roll and pitch would make every transform and collision dearer
// without a use. z is added, never rotated. Headings are wrapped to (-pi, pi] after each composition, so that equal
// directions have equal numbers. All functions are deterministic (deterministic_math.h); NaN passes through, and is
// refused where values come in.
#pragma once

#include <cmath>

#include "troupe/deterministic_math.h"
#include "troupe/fields.h"
#include "troupe/vec2.h"

namespace troupe {

struct Pose {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double heading = 0.0;

  Vec2 translation() const { return {x, y}; }
  bool operator==(const Pose&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"x", &Pose::x}.In("m"),
        Field{"y", &Pose::y}.In("m"),
        Field{"z", &Pose::z}.In("m"),
        Field{"heading", &Pose::heading, "in (-pi, pi], counter-clockwise"}.In("rad"),
    };
  }
};

Pose operator*(const Pose& X_AB, const Pose& X_BC);
Pose Inverse(const Pose& X_AB);
inline bool IsFinite(const Pose& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.z) && std::isfinite(pose.heading);
}

// A pose with its sine and cosine, for transforming many points.
class Transform2 {
 public:
  Transform2() = default;
  explicit Transform2(const Pose& X_AB);

  Vec2 operator*(const Vec2& p_B) const {
    return {p_.x() + cos_ * p_B.x() - sin_ * p_B.y(), p_.y() + sin_ * p_B.x() + cos_ * p_B.y()};
  }
  // That of a pose with the same heading at `p_AB`, with its bits.
  Transform2 MovedTo(const Vec2& p_AB) const {
    Transform2 moved = *this;
    moved.p_ = p_AB;
    return moved;
  }
  // Turns a direction without moving it.
  Vec2 Rotate(const Vec2& v_B) const { return {cos_ * v_B.x() - sin_ * v_B.y(), sin_ * v_B.x() + cos_ * v_B.y()}; }
  Vec2 InverseTransform(const Vec2& p_A) const { return InverseRotate(p_A - p_); }
  Vec2 InverseRotate(const Vec2& v_A) const {
    return {cos_ * v_A.x() + sin_ * v_A.y(), -sin_ * v_A.x() + cos_ * v_A.y()};
  }

 private:
  Vec2 p_ = Vec2::Zero();
  double cos_ = 1.0;
  double sin_ = 0.0;
};

// Velocity of a robot in its own frame R.
struct Twist {
  double vx = 0.0;
  double vy = 0.0;
  double wz = 0.0;

  bool IsZero() const { return vx == 0.0 && vy == 0.0 && wz == 0.0; }
  bool operator==(const Twist&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"vx", &Twist::vx, "forward"}.In("m/s"),
        Field{"vy", &Twist::vy, "to the left"}.In("m/s"),
        Field{"wz", &Twist::wz, "counter-clockwise"}.In("rad/s"),
    };
  }
};

inline bool IsFinite(const Twist& twist) {
  return std::isfinite(twist.vx) && std::isfinite(twist.vy) && std::isfinite(twist.wz);
}

// The motion of frame R during `seconds` under a constant twist, exactly along its arc (the exponential map of SE(2)):
// returns X_R0R1, with z 0.
Pose Integrate(const Twist& twist, double seconds);

}  // namespace troupe
