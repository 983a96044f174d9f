// WalkRoutes: the ways of people through the static bodies of a world, on grids of cells in which a person fits.
//
// A grid for each height, radius and z of people, and on it a field for each goal: the length of the shortest way from
// every cell. A field is made when a person first asks for it, by any thread; it is a pure function of the world.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "common/spatial/scene.h"
#include "troupe/ids.h"
#include "troupe/vec2.h"

namespace troupe {

class WalkRoutes {
 public:
  explicit WalkRoutes(const Scene& scene);
  ~WalkRoutes();

  // The place (m, W) at which a person can stand that is nearest to a point of a goal set: mostly the point itself.
  // Nothing if there is none nearby. REQUIRES, here and below: the set and the point exist.
  std::optional<Vec2> Target(PersonId person, std::uint32_t goals, std::uint32_t point) const;

  // A point (m, W) to which the person can walk straight from `from`, on the shortest way to the target: the target
  // itself where it is near. Nothing if no way is known.
  std::optional<Vec2> NextPoint(PersonId person, std::uint32_t goals, std::uint32_t point, const Vec2& from) const;

  // The length of that way, m, by steps between cells.
  std::optional<double> Length(PersonId person, std::uint32_t goals, std::uint32_t point, const Vec2& from) const;

 private:
  class Layer;
  struct Field;

  const Field& FieldOf(PersonId person, std::uint32_t goals, std::uint32_t point) const;

  std::vector<std::vector<Vec2>> goals_;  // points, by set
  std::vector<std::size_t> first_point_;  // by set: how many points the sets before it have
  std::size_t points_ = 0;                // of all sets
  std::vector<Layer> layers_;
  std::vector<std::size_t> layer_of_;         // by person
  mutable std::vector<std::once_flag> made_;  // by layer and point, like the next
  mutable std::vector<std::unique_ptr<const Field>> fields_;
};

// Those of a scene, once they are asked for.
struct LazyWalkRoutes {
  std::once_flag made;
  std::unique_ptr<const WalkRoutes> routes;
};

}  // namespace troupe
