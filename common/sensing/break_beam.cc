#include "common/sensing/break_beam.h"

#include <algorithm>
#include <memory_resource>
#include <optional>

#include "common/sensing/reading_json.h"

namespace troupe {
namespace {

struct Segment {
  Vec2 from;
  Vec2 to;
  double z = 0.0;  // m
};

// The fraction of the segment before it enters a convex polygon, 0 if it starts inside; nothing if it misses the
// polygon or only touches it.
std::optional<double> EntryOf(const Segment& segment, const std::vector<Vec2>& vertices) {
  const Vec2 direction = segment.to - segment.from;
  double enter = 0.0;
  double leave = 1.0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec2 edge = vertices[(i + 1) % vertices.size()] - vertices[i];
    // Inside is to the left of every edge.
    const double start = Cross(edge, segment.from - vertices[i]) - kTouchTolerance * edge.norm();
    const double gain = Cross(edge, direction);
    if (gain == 0.0) {
      if (start <= 0.0) return std::nullopt;
    } else if (gain > 0.0) {
      enter = std::max(enter, -start / gain);
    } else {
      leave = std::min(leave, -start / gain);
    }
  }
  return enter < leave ? std::optional(enter) : std::nullopt;
}

std::optional<ObjectId> FindObject(const Scene& scene, const BodyIndex& bodies, const Segment& segment,
                                   std::pmr::vector<BodyId>& near) {
  Rectangle box = Rectangle::Nothing();
  box.Extend(segment.from);
  box.Extend(segment.to);
  near.clear();
  bodies.Query(box, near);
  std::optional<ObjectId> nearest;
  double nearest_at = 0.0;
  for (BodyId body : near) {
    if (body.index() < scene.world().robots.size()) continue;
    for (const ConvexPiece& piece : bodies.pieces_in_world(body)) {
      if (!piece.z.Contains(segment.z)) continue;
      const std::optional<double> at = EntryOf(segment, piece.vertices);
      if (!at || (nearest && *at >= nearest_at)) continue;
      nearest = scene.object_of(piece.model);
      nearest_at = *at;
    }
  }
  return nearest;
}

class BreakBeams final : public Sensor {
 public:
  explicit BreakBeams(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line = LineStart(reading.tick, world.robot(robot()).name, description().name) + ",\"broken_by\":[";
    for (const BreakBeamReading::Beam& beam : std::get<BreakBeamReading>(reading.content).beams) {
      if (line.back() != '[') line += ',';
      line += beam.broken_by ? JsonString(world.model(world.objects[beam.broken_by->index()]).name) : "null";
    }
    return line + "]}\n";
  }

 private:
  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    const Pose X_WG = world.bodies.X_WM(description().model);
    const Transform2 to_world(X_WG);
    std::pmr::vector<BodyId> near;
    reading.tick = tick;
    BreakBeamReading& content = ContentOf<BreakBeamReading>(reading);
    content.gripper_model = description().model;
    content.beams.clear();
    for (const BreakBeam& beam : std::get<BreakBeamParameters>(description().parameters).beams) {
      const Segment segment{to_world * beam.from, to_world * beam.to, X_WG.z + beam.z};
      content.beams.push_back({beam, FindObject(world.scene, world.bodies, segment, near)});
    }
  }
};

}  // namespace

std::unique_ptr<const Sensor> MakeBreakBeams(const SensorMount& mount) {
  return std::make_unique<BreakBeams>(mount);
}

}  // namespace troupe
