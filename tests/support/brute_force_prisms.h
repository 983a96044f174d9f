// BruteForcePrisms: single rays in space against every block of a world.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tests/support/exact_prisms.h"
#include "troupe/world_state.h"

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
  BruteForcePrisms(const WorldDescription& world, const WorldState& state, Sees sees)
      : prisms_(ExactPrisms(world, state, sees).Take()) {}

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
  std::vector<ExactPrism> prisms_;
};

}  // namespace troupe::test
