// BruteForceRays: a ray caster without convex pieces and grids. It visits the raw outlines of all models, with more
// digits than the ray caster under test.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/model/world_state.h"
#include "tests/support/test_world.h"

namespace troupe::test {

struct BruteForceHit {
  long double distance;  // m
  ModelId model;
};

class BruteForceRays {
 public:
  // REQUIRES: the world outlives it.
  BruteForceRays(const WorldDescription& world, const WorldState& state) : world_(world) {
    for (std::size_t m = 0; m < world.models.size(); ++m) {
      if (world.models[m].ranger_return >= 0.0) AddModel(ModelId(m), state);
    }
  }

  // The hits of a ray of all outlines within `max_distance`, unsorted. REQUIRES: |direction| = 1
  std::vector<BruteForceHit> Cast(const Vec2& origin, const Vec2& direction, double z, double max_distance,
                                  std::optional<RobotId> caster) const {
    std::vector<BruteForceHit> hits;
    for (const Outline& outline : outlines_) {
      if (caster && world_.robot(*caster).root == outline.root) continue;
      if (z < outline.min_z || z >= outline.max_z) continue;
      const long double distance = Distance(outline.vertices, {origin.x(), origin.y()}, {direction.x(), direction.y()});
      if (distance >= 0.0L && distance <= max_distance) hits.push_back({distance, outline.model});
    }
    return hits;
  }

  static BruteForceHit Nearest(const std::vector<BruteForceHit>& hits) {
    return *std::min_element(hits.begin(), hits.end(),
                             [](const BruteForceHit& a, const BruteForceHit& b) { return a.distance < b.distance; });
  }

 private:
  struct Point {
    long double x;
    long double y;
  };

  struct Frame {
    long double x = 0.0L;
    long double y = 0.0L;
    long double z = 0.0L;
    long double heading = 0.0L;

    Point operator*(const Point& p) const {
      return {x + std::cos(heading) * p.x - std::sin(heading) * p.y,
              y + std::sin(heading) * p.x + std::cos(heading) * p.y};
    }
    Frame operator*(const Frame& inner) const {
      const Point p = *this * Point{inner.x, inner.y};
      return {p.x, p.y, z + inner.z, heading + inner.heading};
    }
  };

  struct Outline {
    std::vector<Point> vertices;  // in the world's frame
    long double min_z;
    long double max_z;
    ModelId model;
    ModelId root;
  };

  static Frame FrameOf(const Pose& pose) { return {pose.x, pose.y, pose.z, pose.heading}; }

  Frame FrameOf(const WorldState& state, ModelId id) const {
    for (std::size_t i = 0; i < world_.robots.size(); ++i) {
      if (world_.robots[i].root == id) return FrameOf(state.robots[i].X_WR);
    }
    for (std::size_t i = 0; i < world_.objects.size(); ++i) {
      if (world_.objects[i] == id) return FrameOf(state.objects[i].X_WO);
    }
    const ModelDescription& model = world_.model(id);
    Frame frame = FrameOf(model.X_PM);
    if (model.parent) frame = FrameOf(state, *model.parent) * frame;
    for (std::size_t i = 0; i < world_.joints.size(); ++i) {
      const JointDescription& joint = world_.joints[i];
      if (joint.model != id) continue;
      const long double q = state.joints[i].position;
      const bool turns = joint.type == JointType::kRevolute;
      frame = frame * (turns ? Frame{0.0L, 0.0L, 0.0L, q}
                             : Frame{q * joint.axis_xy.x(), q * joint.axis_xy.y(), q * joint.axis_z, 0.0L});
    }
    return frame;
  }

  void AddModel(ModelId id, const WorldState& state) {
    ModelId root = id;
    while (world_.model(root).parent) root = *world_.model(root).parent;
    const Frame frame = FrameOf(state, id);
    const Shape& shape = world_.shape(world_.model(id).shape);
    const auto add = [&](const Polygon& polygon, const ZRange& z) {
      Outline outline{{}, z.min + frame.z, z.max + frame.z, id, root};
      for (const Vec2& vertex : polygon) outline.vertices.push_back(frame * Point{vertex.x(), vertex.y()});
      outlines_.push_back(std::move(outline));
    };
    for (const Block& block : shape.blocks) add(block.outline, block.z);
    for (const Rectangle& r : shape.rectangles) add(Box(r.min_x, r.min_y, r.max_x, r.max_y), shape.rectangles_z);
  }

  // Distance to the hit; 0 from inside, negative for a miss.
  static long double Distance(const std::vector<Point>& outline, const Point& origin, const Point& direction) {
    bool inside = false;
    long double nearest = -1.0L;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Point& a = outline[i];
      const Point& b = outline[(i + 1) % outline.size()];
      if ((a.y > origin.y) != (b.y > origin.y) && origin.x < a.x + (b.x - a.x) * (origin.y - a.y) / (b.y - a.y)) {
        inside = !inside;
      }
      const Point edge{b.x - a.x, b.y - a.y};
      const Point to{a.x - origin.x, a.y - origin.y};
      const long double denominator = direction.x * edge.y - direction.y * edge.x;
      if (denominator == 0.0L) continue;
      const long double t = (to.x * edge.y - to.y * edge.x) / denominator;
      const long double s = (to.x * direction.y - to.y * direction.x) / denominator;
      if (t >= 0.0L && s >= 0.0L && s <= 1.0L && (nearest < 0.0L || t < nearest)) nearest = t;
    }
    return inside ? 0.0L : nearest;
  }

  const WorldDescription& world_;
  std::vector<Outline> outlines_;
};

}  // namespace troupe::test
