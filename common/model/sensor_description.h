// SensorDescription: a sensor that is mounted on a robot, of any kind. A kind is an alternative of SensorParameters;
// common/sensing has its measurement.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/base/ids.h"
#include "common/geometry/pose.h"
#include "common/geometry/vec2.h"
#include "common/model/interval.h"

namespace troupe {

inline constexpr std::uint32_t kMaxRaySamples = 100'000;  // of one ray sensor

// One fan of rays. Frame S: the sensor; rays leave from its origin, at its height.
struct RaySensorDescription {
  Pose X_MS;                        // in the ranger model's frame
  Interval range{0.0, 5.0};         // m
  double fov = 0.1;                 // rad; the fan spans -fov/2 .. +fov/2, both ends included
  std::uint32_t samples = 1;        // 1 to kMaxRaySamples; 1: a single ray straight ahead
  double noise_variance = 0.0;      // m^2, added to a hit's range
  double noise_proportional = 0.0;  // a hit's range r gets r * this * uniform(-1, 1)
  double noise_angle = 0.0;         // rad: a ray's bearing gets uniform(-1, 1) * this * step / 2, as in Stage
  bool operator==(const RaySensorDescription&) const = default;
};

// A ranger: one or more ray sensors (a laser scanner has one, a sonar ring many).
struct RangerParameters {
  std::vector<RaySensorDescription> ray_sensors = {};
  bool operator==(const RangerParameters&) const = default;
};

// A light beam across the gap of a gripper: broken when an object is between its ends. Frame G: the gripper's model.
struct BreakBeam {
  Vec2 from{0.0, 0.0};  // m, in frame G
  Vec2 to{0.0, 0.0};    // m, in frame G
  double z = 0.0;       // m, in frame G
  bool operator==(const BreakBeam&) const = default;
};

struct BreakBeamParameters {
  std::vector<BreakBeam> beams = {};
  bool operator==(const BreakBeamParameters&) const = default;
};

using SensorParameters = std::variant<RangerParameters, BreakBeamParameters>;

struct SensorDescription {
  std::string name = {};           // unique on its robot: the model's name without the robot's, "ranger:0"
  ModelId model = {};              // frame M; in the robot's tree
  std::uint32_t period_ticks = 1;  // due at every tick that is a multiple of this
  SensorParameters parameters = {};
  bool operator==(const SensorDescription&) const = default;
};

// Name of a kind of sensor: "ranger", "break_beam".
inline std::string_view TypeOf(const SensorParameters& parameters) {
  struct TypeName {
    std::string_view operator()(const RangerParameters&) const { return "ranger"; }
    std::string_view operator()(const BreakBeamParameters&) const { return "break_beam"; }
  };
  return std::visit(TypeName(), parameters);
}

}  // namespace troupe
