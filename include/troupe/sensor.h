// The readings of sensors, as controllers receive them and Simulation::Measure returns them. SensorReading is the
// result of one measurement of one sensor, of any kind, with the geometry that gives the numbers their meaning: a
// consumer needs no description of the sensor. Plain values; a reading has no errors.
//
//   SensorReading ── RangerReading: scans, one for each ray sensor ── RangeScan: ranges and intensities, one for each
//   ray
//                 └─ BreakBeamReading: beams of one gripper
//
// The descriptions of sensors (SensorDescription, RangerParameters, ...) come with this header.
//
// Frames: W world, R robot, S ray sensor, G the model of a gripper; X_RS is the pose of S in R. Units: m, rad.
#pragma once

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "common/base/ids.h"
#include "common/geometry/pose.h"
#include "common/model/interval.h"
#include "common/model/sensor_description.h"

namespace troupe {

// The bearings of a fan of rays. All users of a fan (ray casting, controllers, pictures, ROS messages) obtain its
// bearings here.
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

// One fan of rays from the origin of S, in its plane z = 0: ranges[i] and intensities[i] belong to the bearing
// fan.Bearing(i) in frame S. Both have the length fan.count.
struct RangeScan {
  std::vector<double> ranges = {};       // m, within `limits`; limits.max without a hit
  std::vector<double> intensities = {};  // ranger_return of the hit, 0 without one
  RayFan fan = {};
  Pose X_RS = {};         // at the measurement: a lift or an arm moves it
  Interval limits = {};   // m
  double variance = 0.0;  // m^2, of the noise that does not depend on the range
  bool operator==(const RangeScan&) const = default;
};

// Of a ranger: one scan for each of its ray sensors, in the order of the world file.
struct RangerReading {
  std::vector<RangeScan> scans = {};
  bool operator==(const RangerReading&) const = default;
};

// Of the break beams of a gripper.
struct BreakBeamReading {
  struct Beam {
    BreakBeam beam = {};                     // in G
    std::optional<ObjectId> broken_by = {};  // the object in the beam that is nearest to its first end
    bool operator==(const Beam&) const = default;
  };
  ModelId gripper_model = {};  // frame G
  std::vector<Beam> beams = {};
  bool operator==(const BreakBeamReading&) const = default;
};

struct SensorReading {
  Tick tick = 0;  // of the measurement; a sensor with a long period keeps its last reading
  // By kind of sensor; std::monostate: never measured.
  std::variant<std::monostate, RangerReading, BreakBeamReading> content = {};

  bool empty() const { return std::holds_alternative<std::monostate>(content); }
  // Null if the reading is empty or of another kind. Not of a temporary, which ends before its content is read.
  const RangerReading* ranger() const& { return std::get_if<RangerReading>(&content); }
  const RangerReading* ranger() const&& = delete;
  const BreakBeamReading* break_beams() const& { return std::get_if<BreakBeamReading>(&content); }
  const BreakBeamReading* break_beams() const&& = delete;

  bool operator==(const SensorReading&) const = default;
};

}  // namespace troupe
