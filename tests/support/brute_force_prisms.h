// BruteForcePrisms: single rays in space against every block of a world, with more digits than the code under test and
// without convex pieces, half planes or indices.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "common/model/world_state.h"
#include "tests/support/test_world.h"

namespace troupe::test {

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

class BruteForcePrisms {
 public:
  // Bodies for which `sees(model)` is false are left out.
  template <typename Sees>
  BruteForcePrisms(const WorldDescription& world, const WorldState& state, Sees sees) : world_(world) {
    for (std::size_t m = 0; m < world.models.size(); ++m) {
      if (sees(ModelId(m))) AddModel(ModelId(m), state);
    }
  }

  // The nearest hit within `most`.
  std::optional<PrismHit> Cast(const SpaceRay& ray, long double most) const {
    std::optional<PrismHit> nearest;
    for (const Prism& prism : prisms_) {
      const auto keep = [&](long double t) {
        if (t >= 0.0L && t <= most && (!nearest || t < nearest->distance)) nearest = PrismHit{t, prism.model};
      };
      const long double z = ray.z;
      const long double climb = ray.climb;
      if (z >= prism.min_z && z < prism.max_z && Contains(prism, ray.origin.x(), ray.origin.y())) keep(0.0L);
      for (const long double face : {prism.min_z, prism.max_z}) {
        if (climb == 0.0L) continue;
        const long double t = (face - z) / climb;
        // From above on the top, from below on the underside.
        if ((face == prism.max_z) != (climb < 0.0L)) continue;
        if (t >= 0.0L &&
            Contains(prism, ray.origin.x() + t * ray.direction.x(), ray.origin.y() + t * ray.direction.y())) {
          keep(t);
        }
      }
      for (std::size_t i = 0; i < prism.outline.size(); ++i) {
        const Point& a = prism.outline[i];
        const Point& b = prism.outline[(i + 1) % prism.outline.size()];
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

  // True if a ray that is turned or raised by a hair has another hit: which one counts is a matter of rounding.
  bool IsOnEdge(const SpaceRay& ray, long double most) const {
    constexpr double kHair = 1e-7;
    const std::optional<PrismHit> straight = Cast(ray, most);
    for (const auto& [turn, raise] : {std::pair(kHair, 0.0), {-kHair, 0.0}, {0.0, kHair}, {0.0, -kHair}}) {
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
  struct Prism {
    std::vector<Point> outline;
    long double min_z;
    long double max_z;
    ModelId model;
  };

  static Frame FrameOf(const Pose& pose) { return {pose.x, pose.y, pose.z, pose.heading}; }

  Frame FrameOfModel(const WorldState& state, ModelId id) const {
    for (std::size_t i = 0; i < world_.robots.size(); ++i) {
      if (world_.robots[i].root == id) return FrameOf(state.robots[i].X_WR);
    }
    const Frame frame = FrameOf(world_.model(id).X_PM);
    return world_.model(id).parent ? FrameOfModel(state, *world_.model(id).parent) * frame : frame;
  }

  void AddModel(ModelId id, const WorldState& state) {
    const Frame frame = FrameOfModel(state, id);
    const Shape& shape = world_.shape(world_.model(id).shape);
    const auto add = [&](const Polygon& polygon, const ZRange& z) {
      Prism prism{{}, z.min + frame.z, z.max + frame.z, id};
      for (const Vec2& vertex : polygon) prism.outline.push_back(frame * Point{vertex.x(), vertex.y()});
      prisms_.push_back(std::move(prism));
    };
    for (const Block& block : shape.blocks) add(block.outline, block.z);
    for (const Rectangle& r : shape.rectangles) add(Box(r.min_x, r.min_y, r.max_x, r.max_y), shape.rectangles_z);
  }

  static bool Contains(const Prism& prism, long double x, long double y) {
    bool inside = false;
    for (std::size_t i = 0; i < prism.outline.size(); ++i) {
      const Point& a = prism.outline[i];
      const Point& b = prism.outline[(i + 1) % prism.outline.size()];
      if ((a.y > y) != (b.y > y) && x < a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y)) inside = !inside;
    }
    return inside;
  }

  const WorldDescription& world_;
  std::vector<Prism> prisms_;
};

}  // namespace troupe::test
