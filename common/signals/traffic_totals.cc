#include "common/signals/traffic_totals.h"

#include <algorithm>
#include <utility>

namespace troupe {
namespace {

constexpr int kLane = 0;
constexpr int kDoor = 1;
constexpr int kLift = 2;
constexpr const char* kKinds[] = {"lane", "door", "lift"};

// The place among the doors or lifts of a world.
template <typename Parts>
std::optional<std::size_t> FindPart(const Parts& parts, ModelId model) {
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.model == model; });
  if (found == parts.end()) return std::nullopt;
  return static_cast<std::size_t>(found - parts.begin());
}

std::string NameOfPlace(const WorldDescription& world, int kind, std::size_t number) {
  if (kind == kDoor) return number < world.doors.size() ? world.model(world.doors[number].model).name : "";
  if (kind == kLift) return number < world.lifts.size() ? world.model(world.lifts[number].model).name : "";
  const std::optional<GraphPlace> lane = FindLane(world.lane_graphs, number);
  return lane ? NameOfLane(world.lane_graphs[lane->graph], lane->number) : "";
}

std::size_t FirstPartOf(const WorldDescription& world, std::size_t number) {
  const std::optional<GraphPlace> lane = FindLane(world.lane_graphs, number);
  if (!lane) return number;
  return number - lane->number + WholeLaneOf(world.lane_graphs[lane->graph], lane->number).parts.front();
}

}  // namespace

void TrafficTotals::Add(const WorldDescription& world, const WorldState& state) {
  if (tick_ && state.tick == *tick_) return;
  if (tick_ && state.tick < *tick_) Clear();
  const bool is_first = !tick_;
  const std::uint64_t ticks = is_first ? 0 : state.tick - *tick_;
  tick_ = state.tick;
  interval_ = world.interval_seconds();
  ticks_ += ticks;
  if (is_first) {
    for (const TrafficRobot& robot : state.traffic_robots) arrivals_at_[robot.robot] = robot.arrivals;
  }
  CountRobots(state, ticks);
  CountWaits(world, state, ticks);
}

void TrafficTotals::CountRobots(const WorldState& state, std::uint64_t ticks) {
  for (const TrafficRobot& row : state.traffic_robots) {
    std::uint32_t& known = arrivals_at_[row.robot];
    // A robot that begins to take part anew counts from 0 on.
    arrivals_ += row.arrivals >= known ? row.arrivals - known : row.arrivals;
    known = row.arrivals;
    if (row.robot.index() >= state.robots.size()) continue;
    robot_ticks_ += ticks;
    const Twist& twist = state.robots[row.robot.index()].twist;
    if (row.goal && !row.has_arrived && !twist.IsZero()) moving_ticks_ += ticks;
  }
}

void TrafficTotals::CountWaits(const WorldDescription& world, const WorldState& state, std::uint64_t ticks) {
  std::vector<Known> known;
  auto before = known_.begin();
  auto planned = state.traffic_robots.begin();
  for (const RobotWait& wait : state.waits) {
    while (before != known_.end() && before->robot < wait.robot) ++before;
    while (planned != state.traffic_robots.end() && planned->robot < wait.robot) ++planned;
    if (planned != state.traffic_robots.end() && planned->robot == wait.robot) waiting_ticks_ += ticks;
    Known row{.robot = wait.robot, .since = wait.since};
    if (wait.lane) row.lane = Place{kLane, *wait.lane};
    if (wait.thing) {
      if (const auto door = FindPart(world.doors, *wait.thing)) row.thing = Place{kDoor, *door};
      if (const auto lift = FindPart(world.lifts, *wait.thing)) row.thing = Place{kLift, *lift};
    }
    const bool goes_on = before != known_.end() && before->robot == wait.robot && before->since == wait.since;
    const Tick duration = state.tick - wait.since;
    if (row.lane) Count(*row.lane, duration, ticks, !goes_on || before->lane != row.lane);
    if (row.thing) Count(*row.thing, duration, ticks, !goes_on || before->thing != row.thing);
    known.push_back(row);
  }
  known_ = std::move(known);
}

void TrafficTotals::Count(const Place& place, Tick duration, std::uint64_t ticks, bool is_new) {
  Waits& waits = waits_[place];
  waits.ticks += ticks;
  waits.longest = std::max(waits.longest, duration);
  waits.count += is_new;
}

TrafficTotal TrafficTotals::total() const {
  TrafficTotal total{.robots = arrivals_at_.size(), .seconds = static_cast<double>(ticks_) * interval_};
  total.arrivals = arrivals_;
  const auto share = [](std::uint64_t part, std::uint64_t all) {
    return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0.0;
  };
  if (total.seconds > 0.0) total.arrivals_per_hour = 3600.0 * static_cast<double>(arrivals_) / total.seconds;
  total.utilisation = share(moving_ticks_, robot_ticks_);
  total.waiting = share(waiting_ticks_, robot_ticks_);
  return total;
}

std::vector<PlaceWaits> TrafficTotals::FindWaits(const WorldDescription& world, std::size_t most_of_kind) const {
  // Those at the parts of a lane of the site are at its first part.
  std::map<Place, Waits> sums;
  for (const auto& [place, waits] : waits_) {
    Waits& sum = sums[place.kind == kLane ? Place{kLane, FirstPartOf(world, place.number)} : place];
    sum.ticks += waits.ticks;
    sum.count += waits.count;
    sum.longest = std::max(sum.longest, waits.longest);
  }
  std::vector<std::pair<Place, Waits>> rows(sums.begin(), sums.end());
  // Equal ones stay in the order of their numbers.
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
    return a.first.kind != b.first.kind ? a.first.kind < b.first.kind : a.second.ticks > b.second.ticks;
  });
  std::vector<PlaceWaits> places;
  std::size_t of_kind[std::size(kKinds)] = {};
  for (const auto& [place, waits] : rows) {
    if (waits.ticks == 0 || ++of_kind[place.kind] > most_of_kind) continue;
    places.push_back({.kind = kKinds[place.kind],
                      .place = NameOfPlace(world, place.kind, place.number),
                      .seconds = static_cast<double>(waits.ticks) * interval_,
                      .longest = static_cast<double>(waits.longest) * interval_,
                      .waits = waits.count});
  }
  return places;
}

}  // namespace troupe
