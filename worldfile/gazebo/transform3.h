// Points and poses in space, of files that have them: Troupe's own poses are upright (troupe/pose.h). Lengths in m,
// angles in rad. T_AB is the pose of frame B in frame A: T_AC = T_AB * T_BC, p_A = T_AB * p_B. Plain sums in a fixed
// order, so that all processors give the same bits.
#pragma once

#include <array>
#include <cmath>

#include "troupe/deterministic_math.h"
#include "troupe/pose.h"

namespace troupe {

struct Vec3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  Vec3 operator+(const Vec3& b) const { return {x + b.x, y + b.y, z + b.z}; }
  Vec3 operator-(const Vec3& b) const { return {x - b.x, y - b.y, z - b.z}; }
  Vec3 operator*(double factor) const { return {x * factor, y * factor, z * factor}; }
  bool operator==(const Vec3&) const = default;
};

inline double Dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 Cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double Length(const Vec3& a) {
  return std::sqrt(Dot(a, a));
}
inline bool IsFinite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

class Transform3 {
 public:
  Transform3() = default;

  // Rotations about the fixed axes x, y and z, in this order: the `pose` of SDF, the `origin` of URDF.
  static Transform3 FromRpy(const Vec3& p, double roll, double pitch, double yaw) {
    const SinCosResult r = SinCos(roll);
    const SinCosResult t = SinCos(pitch);
    const SinCosResult w = SinCos(yaw);
    Transform3 made;
    made.p_ = p;
    made.rows_ = {Vec3{w.cos * t.cos, w.cos * t.sin * r.sin - w.sin * r.cos, w.cos * t.sin * r.cos + w.sin * r.sin},
                  Vec3{w.sin * t.cos, w.sin * t.sin * r.sin + w.cos * r.cos, w.sin * t.sin * r.cos - w.cos * r.sin},
                  Vec3{-t.sin, t.cos * r.sin, t.cos * r.cos}};
    return made;
  }

  // The quaternion need not have length 1; one of length 0 is no rotation.
  static Transform3 FromQuaternion(const Vec3& p, double x, double y, double z, double w) {
    const double length = std::sqrt(x * x + y * y + z * z + w * w);
    Transform3 made;
    made.p_ = p;
    if (!(length > 0.0)) return made;
    x /= length;
    y /= length;
    z /= length;
    w /= length;
    made.rows_ = {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                  Vec3{2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                  Vec3{2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    return made;
  }

  // Any affine map, row by row, as COLLADA has them; only the products below hold for one that is no rotation.
  static Transform3 FromRows(const std::array<Vec3, 3>& rows, const Vec3& p) {
    Transform3 made;
    made.rows_ = rows;
    made.p_ = p;
    return made;
  }

  const Vec3& translation() const { return p_; }
  Vec3 Rotate(const Vec3& v) const { return {Dot(rows_[0], v), Dot(rows_[1], v), Dot(rows_[2], v)}; }
  Vec3 operator*(const Vec3& p) const { return p_ + Rotate(p); }
  Transform3 operator*(const Transform3& b) const {
    Transform3 made;
    made.p_ = *this * b.p_;
    const auto column = [&b](int i) {
      const auto at = [i](const Vec3& row) { return i == 0 ? row.x : i == 1 ? row.y : row.z; };
      return Vec3{at(b.rows_[0]), at(b.rows_[1]), at(b.rows_[2])};
    };
    for (std::size_t row = 0; row < 3; ++row) {
      made.rows_[row] = {Dot(rows_[row], column(0)), Dot(rows_[row], column(1)), Dot(rows_[row], column(2))};
    }
    return made;
  }
  // REQUIRES: a rotation.
  Transform3 Inverse() const {
    Transform3 made;
    made.rows_ = {Vec3{rows_[0].x, rows_[1].x, rows_[2].x}, Vec3{rows_[0].y, rows_[1].y, rows_[2].y},
                  Vec3{rows_[0].z, rows_[1].z, rows_[2].z}};
    made.p_ = made.Rotate(p_) * -1.0;
    return made;
  }

  // Axis z of the frame, in the other one.
  Vec3 z_axis() const { return {rows_[0].z, rows_[1].z, rows_[2].z}; }

  double yaw() const { return Atan2(rows_[1].x, rows_[0].x); }
  double pitch() const { return Atan2(-rows_[2].x, std::sqrt(rows_[0].x * rows_[0].x + rows_[1].x * rows_[1].x)); }
  double roll() const { return Atan2(rows_[2].y, rows_[2].z); }
  // Without the tilt.
  Pose ToPose() const { return {p_.x, p_.y, p_.z, yaw()}; }

 private:
  std::array<Vec3, 3> rows_ = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 p_;
};

// Upright within this angle: authors write pi / 2 as 1.57, which is 0.0008 less.
inline constexpr double kUprightTolerance = 2e-3;  // rad

// Whether the direction is vertical, up or down; it has length 1.
inline bool IsVertical(const Vec3& direction) {
  return direction.x * direction.x + direction.y * direction.y <= kUprightTolerance * kUprightTolerance;
}

}  // namespace troupe
