// SensorReading: the result of one measurement of one sensor, of any kind, with the geometry that gives the numbers
// their meaning: a consumer needs no description of the sensor. Plain values.
//
// Frames: R robot, S ray sensor, G the model of a gripper. Units: m, rad.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "common/base/ids.h"
#include "common/geometry/pose.h"
#include "common/model/interval.h"
#include "common/model/sensor_description.h"
#include "common/sensing/ray_fan.h"

namespace troupe {

// One fan of rays: ranges[i] and intensities[i] belong to the bearing fan.Bearing(i) in frame S.
struct RangeScan {
  std::vector<double> ranges = {};       // m, within `limits`; limits.max without a hit
  std::vector<double> intensities = {};  // ranger_return of the hit, 0 without one
  RayFan fan = {};
  Pose X_RS = {};         // when it was measured: a lift or an arm moves it
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
