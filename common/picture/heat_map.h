// HeatMap: where robots or people spend their time, or where robots wait, in a part of a run, or in several runs: time
// by cells of a grid over the ground. A picture seen from above shows it under the bodies (draw_picture.h).
//
// It adds up the states of the ticks, one after another: the same run gives the same map, live or from a recording.
// Times are whole numbers of a unit, so that a sum of maps does not depend on the order of its parts, such as the cases
// of a test that run in several processes.
//
// Memory is bounded: when more than kMaxCells cells have time, 3 x 3 of them become one. This does not depend on the
// order either, as a map with one more part has at least the cells that it had before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "troupe/enum_names.h"
#include "troupe/rectangle.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

enum class HeatKind : std::uint8_t {
  kRobots = 0,  // the time that robots spend in a cell, moving or not
  kPeople = 1,
  kWaits = 2,  // the time that robots wait there on their ways (RobotWait)
};
constexpr auto NamesOf(HeatKind) {
  return std::array{"robots", "people", "waits"};
}

class HeatMap {
 public:
  static constexpr double kDefaultCell = 0.5;  // m
  static constexpr double kMinCell = 0.05;
  static constexpr double kMaxCell = 100.0;
  static constexpr std::size_t kMaxCells = 100'000;

  // Column and row, and the time in units.
  using Cells = std::map<std::pair<std::int64_t, std::int64_t>, std::uint64_t>;
  // The times of a map, as they are sent to other processes and kept in files.
  struct Times {
    int joined = 0;         // how often 3 x 3 cells have become one
    std::int64_t unit = 0;  // ns; 0: no tick was added yet
    Cells cells = {};

    bool operator==(const Times&) const = default;
  };

  // `cell`: m, the side of a cell, within the bounds above; the origin of the world is the middle of one,
  // as are the places of most sites.
  HeatMap(HeatKind kind, double cell) : kind_(kind), cell_(cell) {}
  // The error: times that no map has.
  static Result<HeatMap> Of(HeatKind kind, double cell, Times times);

  // Only bodies whose heights are from `min` to below `max`, m.
  void SetHeights(double min, double max) { heights_ = {min, max}; }
  // One more tick, which ended with the state. REQUIRES: the state is of the world
  void Add(const WorldDescription& world, const WorldState& state);
  // The times of another map. REQUIRES: it is of the same kind, side of a cell and heights
  void Add(const HeatMap& other);
  void Clear() { times_ = {}; }
  // The number of runs that it is the sum of: the legend says so if it is not 1.
  void SetRuns(std::uint64_t runs) { runs_ = runs; }

  HeatKind kind() const { return kind_; }
  std::uint64_t runs() const { return runs_; }
  double smallest_cell() const { return cell_; }  // m, as it was made with
  double cell() const;                            // m, the side of a cell as it is now
  const Times& times() const { return times_; }
  bool empty() const { return times_.cells.empty(); }
  double most() const;  // s, in a cell

  // Calls visit(rectangle in m, s) for each cell in which time was spent, in a fixed order.
  template <typename Visit>
  void ForEachCell(const Visit& visit) const {
    const double side = cell();
    for (const auto& [place, time] : times_.cells) {
      const double x = (static_cast<double>(place.first) - 0.5) * side;
      const double y = (static_cast<double>(place.second) - 0.5) * side;
      visit(Rectangle{x, y, x + side, y + side}, Seconds(time));
    }
  }

  bool operator==(const HeatMap&) const = default;

 private:
  void Count(const Pose& X_WB, std::uint64_t time);
  // From now on times are multiples of this number of ns, too.
  void UseUnit(std::int64_t nanoseconds);
  void JoinCells();
  void KeepWithinBound();
  double Seconds(std::uint64_t time) const {
    return static_cast<double>(time) * (static_cast<double>(times_.unit) * 1e-9);
  }

  HeatKind kind_;
  double cell_;  // m, of a cell that is not joined
  std::pair<double, double> heights_ = {-1e9, 1e9};
  std::uint64_t runs_ = 1;
  Times times_;
};

}  // namespace troupe
