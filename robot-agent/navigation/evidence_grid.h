// EvidenceGrid: a robot's own map: square cells that its ranger has seen free, occupied, or not yet. Each
// observation counts as evidence, so that a body that has left disappears. Frame E: that of the pose estimate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "troupe/vec2.h"

namespace troupe {

class EvidenceGrid {
 public:
  enum class Cell : std::uint8_t { kUnknown, kFree, kOccupied };

  // A square of `side` m in cells of `cell` m around `center` (m, E). REQUIRES: both > 0, side / cell <= kMostCells
  EvidenceGrid(const Vec2& center, double side, double cell);
  static constexpr double kMostCells = 1000.0;  // along a side

  // A ray from `origin` along the unit vector `direction` that was free for `range` m and ended there at a body if
  // `hit`. The part outside of the grid counts nothing.
  void Observe(const Vec2& origin, const Vec2& direction, double range, bool hit);

  std::size_t width() const { return width_; }  // cells along a side
  std::size_t size() const { return evidence_.size(); }
  double cell() const { return cell_; }  // m
  // The index of the cell at a point; nothing outside.
  std::optional<std::size_t> IndexOf(const Vec2& point) const;
  Vec2 CenterOf(std::size_t index) const;
  Cell operator[](std::size_t index) const {
    return evidence_[index] == 0 ? Cell::kUnknown : evidence_[index] < 0 ? Cell::kFree : Cell::kOccupied;
  }

 private:
  void Add(std::size_t index, int evidence);

  Vec2 corner_;  // the lower left one
  double cell_;
  std::size_t width_;
  std::vector<std::int8_t> evidence_;  // row by row; > 0: occupied
};

// The way (m, E; the centres of cells) from `from` to the nearest cell whose centre is within `reach` m of `goal`, at
// least `clearance` m away from occupied cells where that is possible. Cells never seen cost more than free ones.
// Nothing if no way is known, or a point is outside.
std::optional<std::vector<Vec2>> PlanPath(const EvidenceGrid& grid, const Vec2& from, const Vec2& goal, double reach,
                                          double clearance);

// The same through free cells to the nearest cell that was never seen, which is the last point.
std::optional<std::vector<Vec2>> PlanToUnknown(const EvidenceGrid& grid, const Vec2& from, double clearance);

}  // namespace troupe
