// MappedRoute: a map that a robot makes with its ranger, and the way on it: to a point, or to what it has not seen yet.
//
// The map is of the robot alone, in the frame of its estimate: with odometry it drifts, as a real one would. Cells hold
// small whole numbers of evidence, a hit counting more than a pass, so that a wall appears at once and a person that
// has left disappears after some scans.
//
// Planning is a Dijkstra search over cells with whole-number costs: ways are repeatable, and prefer known and wide
// places. It is done again every 2 s, or when the goal changes: a search in each tick would be most of an agent's time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "robot-agent/navigation/rays.h"
#include "troupe/controller.h"
#include "troupe/vec2.h"

namespace troupe {

// EvidenceGrid: a robot's own map: square cells that its ranger has seen free, occupied, or not yet. Each
// observation counts as evidence, so that a body that has left disappears. Frame E: that of the pose estimate.
class EvidenceGrid {
 public:
  enum class Cell : std::uint8_t { kUnknown, kFree, kOccupied };

  // A square of `side` m in cells of `cell` m around `center` (m, E). REQUIRES: both > 0, side / cell <= kMaxCells
  EvidenceGrid(const Vec2& center, double side, double cell);
  static constexpr double kMaxCells = 1000.0;  // along a side

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

class MappedRoute {
 public:
  struct Settings {
    double side = 40.0;      // m, of the square that is mapped, around the robot's place at its first tick
    double cell = 0.2;       // m
    double clearance = 0.4;  // m, from the robot's origin to an obstacle that it passes
  };

  // REQUIRES: sensor `ranger` is a ranger; the bounds of EvidenceGrid.
  MappedRoute(const RobotInfo& info, std::size_t ranger, const Settings& settings);

  // Adds the reading of the ranger, if it is a new one. Call it each tick.
  void Observe(const Observation& observation);

  // The point (m, E) to drive to next on the way to within `reach` m of `goal`; nothing if no way is known.
  std::optional<Vec2> NextPoint(const Observation& observation, const Vec2& goal, double reach);
  // The same on the way to the nearest place beside unknown ones; nothing if all that can be reached is known.
  std::optional<Vec2> NextUnknown(const Observation& observation);

  // m^2, free and occupied. 0 before the first reading.
  double KnownArea() const;

 private:
  // The next point of the way that is not near yet, or its last one; drops the points before it.
  std::optional<Vec2> FollowPath(const Observation& observation);
  bool IsPlanDue(const Observation& observation) const;

  Settings settings_;
  std::size_t ranger_;
  Shared<std::vector<PlacedRay>> rays_;
  std::optional<EvidenceGrid> grid_;  // from the first reading on
  std::vector<Vec2> path_;            // m, E
  std::optional<Vec2> goal_;          // of the path; nothing: the unknown
  double planned_at_ = -1.0;          // s, simulated; below 0: never
};

}  // namespace troupe
