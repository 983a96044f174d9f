// ExactPrisms: all bodies of a world as prisms in its frame, with more digits than the code under test, and without
// convex pieces, half planes or indices. For brute-force computations.
// The point of it is independence: it shares no geometry with the code under test, so that an error there is not
// repeated here. It is slow, with a cost of all bodies for each question.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "tests/support/test_world.h"
#include "troupe/world_state.h"

namespace troupe::test {

struct ExactPoint {
  long double x;
  long double y;
};

struct ExactPrism {
  std::vector<ExactPoint> outline;
  long double min_z;
  long double max_z;
  ModelId model;
  ModelId root;

  bool Contains(const ExactPoint& point) const {
    bool inside = false;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const ExactPoint& a = outline[i];
      const ExactPoint& b = outline[(i + 1) % outline.size()];
      if ((a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)) {
        inside = !inside;
      }
    }
    return inside;
  }
};

class ExactPrisms {
 public:
  // The prisms of the models for which `sees(model)` is true.
  template <typename Sees>
  ExactPrisms(const WorldDescription& world, const WorldState& state, Sees sees) : world_(world), state_(state) {
    for (std::size_t m = 0; m < world.models.size(); ++m) {
      if (sees(ModelId(m))) Add(ModelId(m));
    }
  }

  std::vector<ExactPrism> Release() { return std::move(prisms_); }

 private:
  struct Frame {
    long double x = 0.0L;
    long double y = 0.0L;
    long double z = 0.0L;
    long double heading = 0.0L;

    ExactPoint operator*(const ExactPoint& p) const {
      return {x + std::cos(heading) * p.x - std::sin(heading) * p.y,
              y + std::sin(heading) * p.x + std::cos(heading) * p.y};
    }
    Frame operator*(const Frame& inner) const {
      const ExactPoint p = *this * ExactPoint{inner.x, inner.y};
      return {p.x, p.y, z + inner.z, heading + inner.heading};
    }
  };

  static Frame FrameOf(const Pose& pose) { return {pose.x, pose.y, pose.z, pose.heading}; }

  Frame FrameOf(ModelId id) const {
    for (std::size_t i = 0; i < world_.robots.size(); ++i) {
      if (world_.robots[i].root == id) return FrameOf(state_.robots[i].X_WR);
    }
    for (std::size_t i = 0; i < world_.objects.size(); ++i) {
      if (world_.objects[i] == id) return FrameOf(state_.objects[i].X_WO);
    }
    const ModelDescription& model = world_.model(id);
    Frame frame = FrameOf(model.X_PM);
    if (model.parent) frame = FrameOf(*model.parent) * frame;
    for (std::size_t i = 0; i < world_.joints.size(); ++i) {
      const JointDescription& joint = world_.joints[i];
      if (joint.model != id) continue;
      const long double q = state_.joints[i].position;
      const bool turns = joint.type == JointType::kRevolute;
      frame = frame * (turns ? Frame{0.0L, 0.0L, 0.0L, q}
                             : Frame{q * joint.axis_xy.x(), q * joint.axis_xy.y(), q * joint.axis_z, 0.0L});
    }
    return frame;
  }

  void Add(ModelId id) {
    ModelId root = id;
    while (world_.model(root).parent) root = *world_.model(root).parent;
    const Frame frame = FrameOf(id);
    const Shape& shape = world_.shape(world_.model(id).shape);
    const auto add = [&](const Polygon& polygon, const ZRange& z) {
      ExactPrism prism{{}, z.min + frame.z, z.max + frame.z, id, root};
      for (const Vec2& vertex : polygon) prism.outline.push_back(frame * ExactPoint{vertex.x(), vertex.y()});
      prisms_.push_back(std::move(prism));
    };
    for (const Block& block : shape.blocks) add(block.outline, block.z);
    for (const Rectangle& r : shape.rectangles) add(Box(r.min_x, r.min_y, r.max_x, r.max_y), shape.rectangles_z);
  }

  const WorldDescription& world_;
  const WorldState& state_;
  std::vector<ExactPrism> prisms_;
};

struct PrismHit {
  long double distance;  // along the ray, in units of the length of its direction
  ModelId model;
};

struct SpaceRay {
  Vec2 origin;
  double z;
  Vec2 direction;
  double climb;
};

// BruteForcePrisms: single rays in space against every block of a world.
class BruteForcePrisms {
 public:
  // Bodies for which `sees(model)` is false are left out.
  template <typename Sees>
  BruteForcePrisms(const WorldDescription& world, const WorldState& state, Sees sees)
      : prisms_(ExactPrisms(world, state, sees).Release()) {}

  // The nearest hit within `most`.
  std::optional<PrismHit> Cast(const SpaceRay& ray, long double most) const {
    std::optional<PrismHit> nearest;
    for (const ExactPrism& prism : prisms_) {
      const auto keep = [&](long double t) {
        if (t >= 0.0L && t <= most && (!nearest || t < nearest->distance)) nearest = PrismHit{t, prism.model};
      };
      const long double z = ray.z;
      const long double climb = ray.climb;
      if (z >= prism.min_z && z < prism.max_z && prism.Contains({ray.origin.x(), ray.origin.y()})) keep(0.0L);
      for (const long double face : {prism.min_z, prism.max_z}) {
        if (climb == 0.0L) continue;
        const long double t = (face - z) / climb;
        // From above on the top, from below on the underside.
        if ((face == prism.max_z) != (climb < 0.0L)) continue;
        if (t >= 0.0L &&
            prism.Contains({ray.origin.x() + t * ray.direction.x(), ray.origin.y() + t * ray.direction.y()})) {
          keep(t);
        }
      }
      for (std::size_t i = 0; i < prism.outline.size(); ++i) {
        const ExactPoint& a = prism.outline[i];
        const ExactPoint& b = prism.outline[(i + 1) % prism.outline.size()];
        const long double ex = b.x - a.x;
        const long double ey = b.y - a.y;
        const long double denominator = ray.direction.x() * ey - ray.direction.y() * ex;
        if (denominator == 0.0L) continue;
        const long double dx = a.x - ray.origin.x();
        const long double dy = a.y - ray.origin.y();
        const long double t = (dx * ey - dy * ex) / denominator;
        const long double s = (dx * ray.direction.y() - dy * ray.direction.x()) / denominator;
        const long double at = z + t * climb;
        if (t >= 0.0L && s >= 0.0L && s <= 1.0L && at >= prism.min_z && at < prism.max_z) keep(t);
      }
    }
    return nearest;
  }

  // The parts of the ray from 0 to `most` inside of the prisms, each with its model; parts of one prism that touch may
  // be several.
  struct Stretch {
    long double enter;
    long double leave;
    ModelId model;
  };
  std::vector<Stretch> Stretches(const SpaceRay& ray, long double most) const {
    std::vector<Stretch> stretches;
    for (const ExactPrism& prism : prisms_) {
      // Between two neighbouring crossings of faces the ray is inside or outside all along.
      std::vector<long double> crossings = {0.0L, most};
      const auto add = [&](long double t) {
        if (t > 0.0L && t < most) crossings.push_back(t);
      };
      for (const long double face : {prism.min_z, prism.max_z}) {
        if (ray.climb != 0.0) add((face - ray.z) / ray.climb);
      }
      for (std::size_t i = 0; i < prism.outline.size(); ++i) {
        const ExactPoint& a = prism.outline[i];
        const ExactPoint& b = prism.outline[(i + 1) % prism.outline.size()];
        const long double ex = b.x - a.x;
        const long double ey = b.y - a.y;
        const long double denominator = ray.direction.x() * ey - ray.direction.y() * ex;
        if (denominator == 0.0L) continue;
        add(((a.x - ray.origin.x()) * ey - (a.y - ray.origin.y()) * ex) / denominator);
      }
      std::sort(crossings.begin(), crossings.end());
      for (std::size_t i = 1; i < crossings.size(); ++i) {
        const long double middle = 0.5L * (crossings[i - 1] + crossings[i]);
        const long double at = ray.z + middle * ray.climb;
        if (at >= prism.min_z && at < prism.max_z &&
            prism.Contains(
                {ray.origin.x() + middle * ray.direction.x(), ray.origin.y() + middle * ray.direction.y()})) {
          stretches.push_back({crossings[i - 1], crossings[i], prism.model});
        }
      }
    }
    return stretches;
  }

  // True if a ray that is turned or raised by the tolerance has another hit: which one counts is a matter of rounding.
  bool IsOnEdge(const SpaceRay& ray, long double most) const {
    constexpr double kTurnTolerance = 1e-7;
    const std::optional<PrismHit> straight = Cast(ray, most);
    for (const auto& [turn, raise] :
         {std::pair(kTurnTolerance, 0.0), {-kTurnTolerance, 0.0}, {0.0, kTurnTolerance}, {0.0, -kTurnTolerance}}) {
      SpaceRay other = ray;
      other.direction += turn * Vec2(-ray.direction.y(), ray.direction.x());
      other.climb += raise;
      const std::optional<PrismHit> hit = Cast(other, most);
      if (hit.has_value() != straight.has_value()) return true;
      if (hit && (hit->model != straight->model || std::abs(hit->distance - straight->distance) > 1e-4L)) return true;
    }
    return false;
  }

 private:
  std::vector<ExactPrism> prisms_;
};

struct BruteForceHit {
  long double distance;  // m
  ModelId model;
};

// BruteForceRays: a ray caster without convex pieces and grids, which visits the outlines of all models.
class BruteForceRays {
 public:
  // REQUIRES: the world outlives it.
  BruteForceRays(const WorldDescription& world, const WorldState& state)
      : world_(world), bodies_(ExactPrisms(world, state, [&](ModelId id) { return IsSeen(id); }).Release()) {}

  // The hits of a ray of all outlines within `max_distance`, unsorted. REQUIRES: |direction| = 1
  std::vector<BruteForceHit> Cast(const Vec2& origin, const Vec2& direction, double z, double max_distance,
                                  std::optional<RobotId> caster) const {
    std::vector<BruteForceHit> hits;
    for (const ExactPrism& body : bodies_) {
      if (caster && world_.robot(*caster).root == body.root) continue;
      if (z < body.min_z || z >= body.max_z) continue;
      const long double distance = Distance(body, {origin.x(), origin.y()}, {direction.x(), direction.y()});
      if (distance >= 0.0L && distance <= max_distance) hits.push_back({distance, body.model});
    }
    return hits;
  }

  static BruteForceHit Nearest(const std::vector<BruteForceHit>& hits) {
    return *std::min_element(hits.begin(), hits.end(),
                             [](const BruteForceHit& a, const BruteForceHit& b) { return a.distance < b.distance; });
  }

 private:
  using Point = ExactPoint;

  bool IsSeen(ModelId id) const { return world_.model(id).ranger_return >= 0.0; }

  // Distance to the hit; 0 from inside, negative for a miss.
  static long double Distance(const ExactPrism& body, const Point& origin, const Point& direction) {
    if (body.Contains(origin)) return 0.0L;
    long double nearest = -1.0L;
    for (std::size_t i = 0; i < body.outline.size(); ++i) {
      const Point& a = body.outline[i];
      const Point& b = body.outline[(i + 1) % body.outline.size()];
      const Point edge{b.x - a.x, b.y - a.y};
      const Point to{a.x - origin.x, a.y - origin.y};
      const long double denominator = direction.x * edge.y - direction.y * edge.x;
      if (denominator == 0.0L) continue;
      const long double t = (to.x * edge.y - to.y * edge.x) / denominator;
      const long double s = (to.x * direction.y - to.y * direction.x) / denominator;
      if (t >= 0.0L && s >= 0.0L && s <= 1.0L && (nearest < 0.0L || t < nearest)) nearest = t;
    }
    return nearest;
  }

  const WorldDescription& world_;
  std::vector<ExactPrism> bodies_;
};

}  // namespace troupe::test
