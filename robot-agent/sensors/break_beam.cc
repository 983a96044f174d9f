#include "robot-agent/sensors/break_beam.h"

#include <algorithm>
#include <memory_resource>

namespace troupe {
namespace {

struct Segment {
  Vec2 from;
  Vec2 to;
  double z = 0.0;  // m
};

// The share of the way along the segment at which it comes into a convex polygon, 0 if it starts inside; nothing if it
// misses the polygon or only touches it.
std::optional<double> EntersAt(const Segment& segment, const std::vector<Vec2>& vertices) {
  const Vec2 way = segment.to - segment.from;
  double enter = 0.0;
  double leave = 1.0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec2 edge = vertices[(i + 1) % vertices.size()] - vertices[i];
    // Inside is to the left of every edge.
    const double start = Cross(edge, segment.from - vertices[i]) - kTouchTolerance * edge.norm();
    const double gain = Cross(edge, way);
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
      const std::optional<double> at = EntersAt(segment, piece.vertices);
      if (!at || (nearest && *at >= nearest_at)) continue;
      nearest = scene.object_of(piece.model);
      nearest_at = *at;
    }
  }
  return nearest;
}

}  // namespace

void MeasureBeams(const Scene& scene, const BodyIndex& bodies, GripperId id,
                  std::vector<std::optional<ObjectId>>& broken_by) {
  const GripperDescription& gripper = scene.world().gripper(id);
  const Pose X_WG = bodies.X_WM(gripper.model);
  const Transform2 to_world(X_WG);
  std::pmr::vector<BodyId> near;
  broken_by.clear();
  for (const BreakBeam& beam : gripper.beams) {
    broken_by.push_back(FindObject(scene, bodies, {to_world * beam.from, to_world * beam.to, X_WG.z + beam.z}, near));
  }
}

}  // namespace troupe
