// Places for the models of a scenario's spawn rules: rejection sampling in the rule's region.
//
// Every draw has a key (seed, rule, model, draw, component) instead of a running generator, so that a rejected draw
// shifts no draw of another model, and the draws of a rule with its own seed do not depend on the other rules. Models
// are placed one after another, in the order of the rules; nothing is moved again, so that a tight region can fail
// although a packing exists.
//
// Cost: a few queries of the static index and of a hash of cells per draw. Poses: metres, radians, frame W.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "troupe/rectangle.h"
#include "troupe/result.h"
#include "worldfile/models/build_world.h"
#include "worldfile/scenario/scenario_tree.h"

namespace troupe {

// After so many draws for one model the region counts as full.
inline constexpr std::uint64_t kMaxSpawnDraws = 5000;

// The world with a pose for every model of `spawns`, in order: drawn from the rule's region until the model keeps the
// rule's spacing and overlaps nothing that can be hit or seen, neither in the world nor among the models placed before.
// Overlap is that of collisions: in area and in height. The same world, rules and `seed` give the same poses. The error
// counts the models that found room.
Result<LoadedWorld> PlaceSpawns(LoadedWorld loaded, const std::vector<PlannedSpawn>& spawns, std::uint64_t seed,
                                std::uint64_t max_draws = kMaxSpawnDraws);

// CellMap: an index of the boxes near a box, to which boxes are added one by one. Only cells with boxes use memory, so
// that the size of the world does not matter.
class CellMap {
 public:
  // Best with boxes of about `cell_size` metres: each is in a few cells then.
  explicit CellMap(double cell_size) : cell_size_(std::max(cell_size, kMinCell)) {}

  // REQUIRES: box is not empty, within 1000 km of the origin
  void Insert(const Rectangle& box, std::uint32_t number) {
    const Range cells = CellsOf(box);
    for (std::int64_t row = cells.min_row; row <= cells.max_row; ++row) {
      for (std::int64_t column = cells.min_column; column <= cells.max_column; ++column) {
        numbers_[{row, column}].push_back(number);
      }
    }
  }

  // Whether `matches(number)` is true for any of the boxes that may overlap `box`. It may be called twice for one.
  template <typename Matches>
  bool AnyNear(const Rectangle& box, Matches matches) const {
    const Range cells = CellsOf(box);
    for (std::int64_t row = cells.min_row; row <= cells.max_row; ++row) {
      for (std::int64_t column = cells.min_column; column <= cells.max_column; ++column) {
        const auto cell = numbers_.find({row, column});
        if (cell != numbers_.end() && std::any_of(cell->second.begin(), cell->second.end(), matches)) return true;
      }
    }
    return false;
  }

 private:
  static constexpr double kMinCell = 1e-3;  // m

  struct Range {
    std::int64_t min_column, min_row, max_column, max_row;
  };
  Range CellsOf(const Rectangle& box) const {
    return {CellOf(box.min_x), CellOf(box.min_y), CellOf(box.max_x), CellOf(box.max_y)};
  }
  std::int64_t CellOf(double coordinate) const {
    return static_cast<std::int64_t>(std::floor(coordinate / cell_size_));
  }

  double cell_size_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::uint32_t>> numbers_;  // by row and column
};

}  // namespace troupe
