// The starts of the walks of many rays over a grid, computed together by vector instructions.
//
// A walk over an empty map is so short that its start takes longest; eight starts at a time by vector instructions are
// worth the columns. Results are equal to the results of GridWalk's constructor, with the same cells, on every
// processor.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "common/base/instructions.h"
#include "common/spatial/grid_walk.h"
#include "troupe/vec2.h"

namespace troupe {

// Up to 16 rays, by columns.
class WalkBlock {
 public:
  static constexpr std::size_t kLanes = 16;

  // REQUIRES: |direction| = 1; inverse = 1 / direction by components; there are fewer than 16 rays.
  void Add(const Vec2& origin, const Vec2& direction, const Eigen::Array2d& inverse, double max_distance) {
    x_[count_] = origin.x();
    y_[count_] = origin.y();
    dx_[count_] = direction.x();
    dy_[count_] = direction.y();
    inverse_x_[count_] = inverse.x();
    inverse_y_[count_] = inverse.y();
    max_distance_[count_] = max_distance;
    ++count_;
  }
  std::size_t size() const { return count_; }

  // walks[i] = GridWalk(grid, ray i), with the same steps. REQUIRES: walks.size() == size()
  void Start(const Grid& grid, std::span<GridWalk> walks) const;

  using Starter = void(const WalkBlock& rays, const Grid& grid, std::span<GridWalk> walks);
  // The starters that this processor can run, the quickest last.
  static std::span<const Variant<Starter>> Starters();

 private:
  friend class WalkStarters;
  using Column = std::array<double, kLanes>;

  // Without values where there is no ray: the results of those lanes are not used.
  alignas(64) Column x_;
  Column y_;
  Column dx_;
  Column dy_;
  Column inverse_x_;
  Column inverse_y_;
  Column max_distance_;
  std::size_t count_ = 0;
};

}  // namespace troupe
