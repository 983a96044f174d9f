#include "common/picture/heat_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/geometry/limits.h"

namespace troupe {
namespace {

constexpr int kMaxJoined = 40;                      // 3^40 cells are more than any world has
constexpr double kFarthest = 10.0 * kMaxMagnitude;  // m, from the origin: a body that is farther away counts as there

// Of three cells in a row, of which the middle one's number is a multiple of 3, the number of the joined one.
std::int64_t Joined(std::int64_t number) {
  const std::int64_t shifted = number + 1;
  return shifted >= 0 ? shifted / 3 : -((2 - shifted) / 3);
}

std::int64_t Joined(std::int64_t number, int times) {
  for (int i = 0; i < times; ++i) number = Joined(number);
  return number;
}

std::int64_t NumberOf(double metres, double cell) {
  return static_cast<std::int64_t>(std::floor(std::clamp(metres, -kFarthest, kFarthest) / cell + 0.5));
}

}  // namespace

Result<HeatMap> HeatMap::Of(HeatKind kind, double cell, Times times) {
  if (!(cell >= kMinCell && cell <= kMaxCell)) return BadInput("found a heat map with cells of another size");
  if (times.joined < 0 || times.joined > kMaxJoined || times.unit < 0 || times.cells.size() > kMaxCells) {
    return BadInput("found a heat map out of bounds");
  }
  const std::int64_t least = Joined(NumberOf(-kFarthest, cell), times.joined);
  const std::int64_t greatest = Joined(NumberOf(kFarthest, cell), times.joined);
  const auto is_there = [&](std::int64_t number) { return number >= least && number <= greatest; };
  for (const auto& [place, time] : times.cells) {
    if (!is_there(place.first) || !is_there(place.second) || time == 0 || times.unit == 0) {
      return BadInput("found a cell that no heat map has");
    }
  }
  HeatMap map(kind, cell);
  map.times_ = std::move(times);
  return map;
}

void HeatMap::Add(const WorldDescription& world, const WorldState& state) {
  UseUnit(world.interval_ns);
  const auto time = static_cast<std::uint64_t>(world.interval_ns / times_.unit);
  if (kind_ == HeatKind::kRobots) {
    for (std::size_t i = 0; i < state.robots.size(); ++i) {
      if (RobotExists(world, RobotId(i))) Count(state.robots[i].X_WR, time);
    }
  } else if (kind_ == HeatKind::kPeople) {
    for (std::size_t i = 0; i < state.people.size(); ++i) {
      if (!world.model(world.people[i].root).removed && !IsAway(state.people[i])) Count(state.people[i].X_WP, time);
    }
  } else {
    for (const RobotWait& wait : state.waits) {
      if (wait.robot.index() < state.robots.size()) Count(state.robots[wait.robot.index()].X_WR, time);
    }
  }
  KeepWithinBound();
}

void HeatMap::Add(const HeatMap& other) {
  if (other.times_.unit == 0) return;
  HeatMap added = other;
  UseUnit(added.times_.unit);
  added.UseUnit(times_.unit);
  while (times_.joined < added.times_.joined) JoinCells();
  while (added.times_.joined < times_.joined) added.JoinCells();
  for (const auto& [place, time] : added.times_.cells) {
    times_.cells[place] += time;
  }
  KeepWithinBound();
}

void HeatMap::UseUnit(std::int64_t nanoseconds) {
  const std::int64_t unit = std::gcd(times_.unit, nanoseconds);
  if (unit == times_.unit) return;
  const auto factor = static_cast<std::uint64_t>(times_.unit / unit);
  for (auto& [place, time] : times_.cells) time *= factor;
  times_.unit = unit;
}

// The place is that of the smallest cells first, so that rounding is the same however often cells were joined when the
// tick came.
void HeatMap::Count(const Pose& X_WB, std::uint64_t time) {
  if (X_WB.z < heights_.first || X_WB.z >= heights_.second) return;
  const auto number = [this](double metres) { return Joined(NumberOf(metres, cell_), times_.joined); };
  times_.cells[{number(X_WB.x), number(X_WB.y)}] += time;
}

void HeatMap::JoinCells() {
  Cells joined;
  for (const auto& [place, time] : times_.cells) joined[{Joined(place.first), Joined(place.second)}] += time;
  times_.cells = std::move(joined);
  ++times_.joined;
}

void HeatMap::KeepWithinBound() {
  while (times_.cells.size() > kMaxCells) JoinCells();
}

double HeatMap::cell() const {
  double side = cell_;
  for (int i = 0; i < times_.joined; ++i) side *= 3.0;
  return side;
}

double HeatMap::most() const {
  std::uint64_t most = 0;
  for (const auto& [place, time] : times_.cells) most = std::max(most, time);
  return Seconds(most);
}

}  // namespace troupe
