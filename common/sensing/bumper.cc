#include "common/sensing/bumper.h"

#include <algorithm>
#include <array>
#include <vector>

#include "common/sensing/contact_search.h"
#include "common/sensing/reading_json.h"

namespace troupe {
namespace {

std::array<Vec2, 2> EndsOf(const Pose& X_FB, double length) {
  const Transform2 transform(X_FB);
  return {transform * Vec2(0.0, -0.5 * length), transform * Vec2(0.0, 0.5 * length)};
}

class Bumper final : public Sensor {
 public:
  explicit Bumper(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line = LineStart(reading.tick, world.robot(robot()).name, description().name) + ",\"pressed_by\":[";
    for (const BumperReading::Segment& segment : std::get<BumperReading>(reading.content).segments) {
      if (line.back() != '[') line += ',';
      line += segment.pressed_by ? JsonString(world.model(*segment.pressed_by).name) : "null";
    }
    return line + "]}\n";
  }

  void AddMarks(const SensedWorld& world, const SensorReading& reading, std::vector<Mark>& marks) const override {
    const Pose& X_WR = world.bodies.X_WB(world.scene.body_of(robot()));
    for (const BumperReading::Segment& segment : std::get<BumperReading>(reading.content).segments) {
      const Pose X_WB = X_WR * segment.X_RB;
      const std::array<Vec2, 2> ends = EndsOf(X_WB, segment.length);
      marks.push_back({MarkShape::kLine,
                       segment.pressed_by ? MarkRole::kTouched : MarkRole::kIdle,
                       X_WB.z,
                       {ends.begin(), ends.end()}});
    }
  }

 private:
  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    const BumperParameters& parameters = std::get<BumperParameters>(description().parameters);
    const Pose X_RM = MountAt(world);
    const Pose X_WM = world.bodies.X_WM(description().model);
    reading.tick = tick;
    BumperReading& content = ContentOf<BumperReading>(reading);
    content.height = parameters.height;
    content.segments.clear();
    for (const BumperSegment& segment : parameters.segments) {
      const Pose X_WB = X_WM * segment.X_MB;
      // The ends feel nothing: a contact at a corner presses the segment that faces it, not its neighbour.
      const std::array<Vec2, 2> ends = EndsOf(X_WB, std::max(segment.length - 4.0 * kContactReach, 0.0));
      std::optional<ModelId> pressed_by;
      for (const Touch& touch : FindTouches(world, robot(), ends, {X_WB.z, X_WB.z + parameters.height})) {
        if (!pressed_by || touch.other < *pressed_by) pressed_by = touch.other;
      }
      content.segments.push_back({X_RM * segment.X_MB, segment.length, pressed_by});
    }
  }
};

}  // namespace

std::unique_ptr<const Sensor> MakeBumper(const SensorMount& mount) {
  return std::make_unique<Bumper>(mount);
}

}  // namespace troupe
