#include "common/sensing/contact.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory_resource>
#include <utility>

#include "common/sensing/sensor_kinds.h"

namespace troupe {
namespace {

class ContactSensor final : public Sensor {
 public:
  explicit ContactSensor(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line;
    JsonWriter json(line);
    BeginReading(json, reading.tick, world.robot(robot()).name, description().name);
    json.Key("contacts").BeginList();
    for (const BodyContact& contact : std::get<ContactReading>(reading.content).contacts) {
      json.BeginObject().Member("part", world.model(contact.part).name);
      json.Member("other", world.model(contact.other).name);
      json.Member("point", std::array{contact.point.x(), contact.point.y()});
      json.Member("z", std::array{contact.z_min, contact.z_max}).EndObject();
    }
    json.EndList().EndObject();
    return line + "\n";
  }

  void AddMarks(const SensedWorld& /*world*/, const SensorReading& reading, std::vector<Mark>& marks) const override {
    for (const BodyContact& contact : std::get<ContactReading>(reading.content).contacts) {
      marks.push_back({MarkShape::kDot, MarkRole::kTouched, 0.5 * (contact.z_min + contact.z_max), {contact.point}});
    }
  }

 private:
  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    // Ordered by ids, so that the reading does not depend on the order of the queries. A part touches a model with many
    // pieces; only the nearest pair of pieces is reported.
    std::map<std::pair<ModelId, ModelId>, Touch> nearest;  // by part and other
    for (const ConvexPiece& piece : world.bodies.pieces_in_world(world.scene.body_of(robot()))) {
      if (!piece.obstacle || !HasHeight(piece.z)) continue;
      for (const Touch& touch : FindTouches(world, robot(), piece.vertices, piece.z)) {
        const auto [known, is_new] = nearest.try_emplace({piece.model, touch.other}, touch);
        if (!is_new && touch.points.distance < known->second.points.distance) known->second = touch;
      }
    }
    reading.tick = tick;
    ContactReading& content = ContentOf<ContactReading>(reading);
    content.contacts.clear();
    for (const auto& [models, touch] : nearest) {
      content.contacts.push_back({.part = models.first,
                                  .other = models.second,
                                  .point = 0.5 * (touch.points.a + touch.points.b),
                                  .z_min = touch.z.min,
                                  .z_max = touch.z.max});
    }
  }
};

std::array<Vec2, 2> EndsOf(const Pose& X_FB, double length) {
  const Transform2 transform(X_FB);
  return {transform * Vec2(0.0, -0.5 * length), transform * Vec2(0.0, 0.5 * length)};
}

class Bumper final : public Sensor {
 public:
  explicit Bumper(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line;
    JsonWriter json(line);
    BeginReading(json, reading.tick, world.robot(robot()).name, description().name);
    json.Key("pressed_by").BeginList();
    for (const BumperReading::Segment& segment : std::get<BumperReading>(reading.content).segments) {
      segment.pressed_by ? json.Value(world.model(*segment.pressed_by).name) : json.Null();
    }
    json.EndList().EndObject();
    return line + "\n";
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
    // Moved inwards by the tolerance: an object that only touches the beam does not break it.
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
    // Robots, people, leaves of doors and cabins do not break a beam, nor hide the object behind them.
    const std::optional<ObjectId> object = scene.object_of(body);
    if (!object) continue;
    for (const ConvexPiece& piece : bodies.pieces_in_world(body)) {
      if (!piece.z.Contains(segment.z)) continue;
      const std::optional<double> at = EntryOf(segment, piece.vertices);
      // Not replaced by an equal one: bodies come in the order of their ids.
      if (!at || (nearest && *at >= nearest_at)) continue;
      nearest = object;
      nearest_at = *at;
    }
  }
  return nearest;
}

class BreakBeams final : public Sensor {
 public:
  explicit BreakBeams(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line;
    JsonWriter json(line);
    BeginReading(json, reading.tick, world.robot(robot()).name, description().name);
    json.Key("broken_by").BeginList();
    for (const BreakBeamReading::Beam& beam : std::get<BreakBeamReading>(reading.content).beams) {
      beam.broken_by ? json.Value(world.model(world.objects[beam.broken_by->index()]).name) : json.Null();
    }
    json.EndList().EndObject();
    return line + "\n";
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

std::unique_ptr<const Sensor> MakeContactSensor(const SensorMount& mount) {
  return std::make_unique<ContactSensor>(mount);
}

std::unique_ptr<const Sensor> MakeBumper(const SensorMount& mount) {
  return std::make_unique<Bumper>(mount);
}

std::vector<Touch> FindTouches(const SensedWorld& world, RobotId robot, std::span<const Vec2> outline,
                               const ZRange& z) {
  Rectangle box = Rectangle::Nothing();
  for (const Vec2& vertex : outline) box.Extend(vertex);
  box = box.Inflated(kContactReach);
  std::vector<Touch> touches;
  const auto test = [&](const ConvexPiece& piece) {
    if (!piece.obstacle || !HasHeight(piece.z)) return;
    // Overlaps is false for a range without height, which a flat bumper has.
    if (z.min == z.max ? !piece.z.Contains(z.min) : !piece.z.Overlaps(z)) return;
    const NearestPoints points = FindNearestPoints(outline, piece.vertices);
    if (points.distance > kContactReach) return;
    touches.push_back({piece.model, points, {std::max(z.min, piece.z.min), std::min(z.max, piece.z.max)}});
  };
  NearPieces near;
  world.scene.static_index().Query(box, near);
  for (const ConvexPiece* piece : near) test(*piece);
  std::pmr::vector<BodyId> bodies;
  world.bodies.Query(box, bodies);
  for (const BodyId body : bodies) {
    if (world.bodies.owner(body) == robot) continue;
    for (const ConvexPiece& piece : world.bodies.pieces_in_world(body)) test(piece);
  }
  return touches;
}

std::unique_ptr<const Sensor> MakeBreakBeams(const SensorMount& mount) {
  return std::make_unique<BreakBeams>(mount);
}

}  // namespace troupe
