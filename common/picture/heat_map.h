// HeatMap: where robots or people spend their time, or where robots wait, in a part of a run: seconds by cells of a
// grid over the ground. A picture seen from above shows it under the bodies (draw_picture.h).
//
// It adds up the states of the ticks, one after another: the same run gives the same map, live or from a recording.
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "troupe/enum_names.h"
#include "troupe/rectangle.h"
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

  // `cell`: m, the side of a cell, within the bounds above; the origin of the world is the middle of one,
  // as are the places of most sites.
  HeatMap(HeatKind kind, double cell) : kind_(kind), cell_(cell) {}

  // Only bodies whose heights are from `min` to below `max`, m.
  void SetHeights(double min, double max) { heights_ = {min, max}; }
  // One more tick, which ended with the state. REQUIRES: the state is of the world
  void Add(const WorldDescription& world, const WorldState& state);
  void Clear() { ticks_.clear(); }

  HeatKind kind() const { return kind_; }
  double cell() const { return cell_; }
  bool empty() const { return ticks_.empty(); }
  double most() const;  // s, in a cell

  // Calls visit(rectangle in m, s) for each cell in which time was spent, in a fixed order.
  template <typename Visit>
  void ForEachCell(const Visit& visit) const {
    for (const auto& [place, ticks] : ticks_) {
      const double x = (static_cast<double>(place.first) - 0.5) * cell_;
      const double y = (static_cast<double>(place.second) - 0.5) * cell_;
      visit(Rectangle{x, y, x + cell_, y + cell_}, static_cast<double>(ticks) * interval_);
    }
  }

 private:
  void Count(const Pose& X_WB);

  HeatKind kind_;
  double cell_;
  std::pair<double, double> heights_ = {-1e9, 1e9};
  double interval_ = 0.0;                                                 // s
  std::map<std::pair<std::int64_t, std::int64_t>, std::uint64_t> ticks_;  // by column and row
};

}  // namespace troupe
