// Sensor: one sensor of one robot. The kinds are declared in sensor_kinds.h and listed in sensor_suite.cc.
//
// A reading is a pure function of the world description (with its seed), the state and the tick: every process that has
// the state (agent, viewer, replay, picture) measures the same bits. So noise has no generator with a state: each
// random number is drawn by a key of seed, robot, sensor, tick and its place in the reading (troupe/random.h). A
// skipped or repeated measurement changes no other.
//
// Geometry is exact: rays are cast against polygons and boxes, not against a grid, and at equal distance the lowest
// model id wins. Lengths in m, angles in rad; frame S is the sensor's own, M its model's, R its robot's, W the world's.
//
// Threads: a sensor is immutable; several threads may measure with it, each with a BodyIndex of its own.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/json_writer.h"
#include "common/model/mark.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/deterministic_math.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/sensor.h"
#include "troupe/sensor_description.h"

namespace troupe {

// A state of the world, prepared for measurements. `bodies` is an index of `scene`.
struct SensedWorld {
  const Scene& scene;
  const BodyIndex& bodies;
  // The state that `bodies` holds, for kinds of sensors that measure more of it than bodies, such as the radio; null:
  // as a state without it.
  const WorldState* state = nullptr;
};

// The place of a sensor in the world: number `index` of the sensors of `robot` (MountedSensors).
struct SensorMount {
  const Scene& scene;
  RobotId robot;
  std::size_t index;
  const SensorDescription& description;
};

class Sensor {
 public:
  virtual ~Sensor() = default;
  Sensor(const Sensor&) = delete;
  Sensor& operator=(const Sensor&) = delete;

  RobotId robot() const { return robot_; }
  std::size_t index() const { return index_; }  // among the robot's sensors
  const SensorDescription& description() const { return description_; }
  bool IsDueAt(Tick tick) const { return tick % description_.period_ticks == 0; }

  // The reading in the state of `world`, at `tick`, due or not.
  // REQUIRES: the robot and its models have the same ids in `world` as in the scene that the sensor was made for.
  SensorReading Measure(const SensedWorld& world, Tick tick) const;

  // One JSON object a line, for a scan log: {"tick":12,"robot":"r0","sensor":"ranger:0.1", ...}, each with its line
  // end. REQUIRES: `reading` is of this sensor and not empty.
  virtual std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const = 0;

  // Appends the drawing of a reading that was measured in `world`, for pictures. By default nothing; the fans of
  // rangers are drawn from their readings.
  virtual void AddMarks(const SensedWorld& world, const SensorReading& reading, std::vector<Mark>& marks) const;

 protected:
  // X_RM at present.
  Pose MountAt(const SensedWorld& world) const;

  explicit Sensor(const SensorMount& mount);

 private:
  friend class SensorSuite;
  // Replaces `reading` and reuses its memory: measurements of every tick allocate nothing for the reading, and write no
  // more than has changed. REQUIRES: `reading` is empty, or a reading of this sensor
  virtual void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const = 0;

  RobotId robot_;
  std::size_t index_;
  SensorDescription description_;
};

// The content of `reading` for a kind of sensor; replaces the content of another kind. For MeasureInto.
template <typename Content>
Content& ContentOf(SensorReading& reading) {
  if (Content* content = std::get_if<Content>(&reading.content)) return *content;
  return reading.content.emplace<Content>();
}

// The place where a sensor with a field of view looks, as a mark.
// The sector of radius `range` (m) around the x axis of S.
inline Mark SectorMark(const Pose& X_WS, double fov, double range) {
  constexpr int kSteps = 32;
  Mark mark{MarkShape::kArea, MarkRole::kReach, X_WS.z, {X_WS.translation()}};
  for (int i = 0; i <= kSteps; ++i) {
    const SinCosResult at = SinCos(X_WS.heading + fov * (static_cast<double>(i) / kSteps - 0.5));
    mark.points.push_back(X_WS.translation() + range * Vec2(at.cos, at.sin));
  }
  return mark;
}

// The poses and colours of models as sensors see them.

// X_WM of any model, static or moving.
inline Pose PoseOfModel(const SensedWorld& world, ModelId model) {
  return world.scene.body_of(model) ? world.bodies.X_WM(model) : world.scene.X_LM(model);
}

// The colour of a model at `tick`.
inline Color ColorOfModel(const SensedWorld& world, ModelId model, Tick tick) {
  const WorldDescription& description = world.scene.world();
  const std::optional<std::size_t> row = world.state != nullptr ? world.scene.light_of(model) : std::nullopt;
  const bool is_switched_on =
      row ? world.state->lights[*row].is_switched_on : description.model(model).blinking.is_switched_on;
  return ColorAt(description.model(model), static_cast<std::int64_t>(tick) * description.interval_ns, is_switched_on);
}

// Begins the JSON line of a reading, an object: `{"tick":12,"robot":"r0","sensor":"ranger:0"`.
void BeginReading(JsonWriter& json, Tick tick, const std::string& robot, const std::string& sensor);

}  // namespace troupe
