// RayFan: the bearings of a fan of rays. All users of a fan (ray casting, controllers, pictures, ROS messages) obtain
// its bearings here.
#pragma once

#include <cstddef>

namespace troupe {

struct RayFan {
  double fov = 0.0;       // rad, from the first ray to the last; the width of the cone of a single ray
  std::size_t count = 1;  // rays; a single one points straight ahead

  // Bearing of ray i in frame S, rad, counter-clockwise. The first is exactly -fov/2, the last exactly fov/2, and ray i
  // exactly the negative of ray count - 1 - i. REQUIRES: i < count
  double Bearing(std::size_t i) const {
    if (count < 2) return 0.0;
    const double last = static_cast<double>(count - 1);
    // From the middle outwards, for the symmetry.
    return fov * ((2.0 * static_cast<double>(i) - last) / (2.0 * last));
  }

  // rad. Bearing(i) is angle_min() + i * angle_increment() up to rounding.
  double angle_min() const { return Bearing(0); }
  double angle_max() const { return count < 2 ? 0.0 : Bearing(count - 1); }
  double angle_increment() const { return count < 2 ? 0.0 : fov / static_cast<double>(count - 1); }

  bool operator==(const RayFan&) const = default;
};

}  // namespace troupe
