// The signals of waits (RobotWait): of a robot what it waits for and for how long; of a door, a lift or a lane how many
// robots wait there, and the longest of these waits. Rows of waits are few: each signal searches them.
#include <algorithm>

#include "common/signals/state_tables.h"

namespace troupe {
namespace {

const RobotWait* FindWaitOf(const SignalView& view, std::size_t robot) {
  const std::vector<RobotWait>& rows = view.state.waits;
  const auto row = std::lower_bound(rows.begin(), rows.end(), RobotId(robot),
                                    [](const RobotWait& a, RobotId b) { return a.robot < b; });
  return row != rows.end() && row->robot == RobotId(robot) ? &*row : nullptr;
}

double SecondsOf(const SignalView& view, const RobotWait& wait) {
  return static_cast<double>(view.state.tick - wait.since) * view.world.interval_seconds();
}

// Where it waits without a known thing, if the traffic has closed that lane.
std::optional<GraphPlace> FindClosedLane(const SignalView& view, const RobotWait& wait) {
  if (wait.thing || !wait.lane) return std::nullopt;
  const bool is_closed = std::any_of(
      view.state.lane_closures.begin(), view.state.lane_closures.end(),
      [&](const LaneClosure& closure) { return closure.lane == *wait.lane && closure.until > view.state.tick; });
  return is_closed ? FindLane(view.world.lane_graphs, *wait.lane) : std::nullopt;
}

void AddOfWaitingRobots(StateTable& table) {
  table.AddNumber("wait_time", "s", "since it stands on its way to a goal; 0: it does not wait",
                  [](const SignalView& view, std::size_t row) {
                    const RobotWait* const wait = FindWaitOf(view, row);
                    return wait != nullptr ? SecondsOf(view, *wait) : 0.0;
                  });
  Signal blocked_by{"blocked_by",
                    "",
                    "the robot, person, object, door, lift or closed lane for which it waits",
                    ValueType::kText,
                    {}};
  // Lanes come after all models.
  blocked_by.number = [](const SignalView& view, std::size_t row) {
    const RobotWait* const wait = FindWaitOf(view, row);
    if (wait == nullptr) return kNoNumber;
    if (wait->thing) return static_cast<double>(wait->thing->index());
    return FindClosedLane(view, *wait) ? static_cast<double>(view.world.models.size() + *wait->lane) : kNoNumber;
  };
  blocked_by.text = [](const SignalView& view, std::size_t row) {
    const RobotWait* const wait = FindWaitOf(view, row);
    if (wait == nullptr) return std::string();
    if (wait->thing) return view.world.model(*wait->thing).name;
    const std::optional<GraphPlace> lane = FindClosedLane(view, *wait);
    return lane ? NameOfLane(view.world.lane_graphs[lane->graph], lane->number) : std::string();
  };
  table.Add(std::move(blocked_by));
}

// `is_for(view, row of the table, wait)`: whether the robot waits there.
template <typename IsFor>
void AddOfPlaces(StateTable& table, const char* waiting, const char* longest, IsFor is_for) {
  table.AddNumber("waiting_robots", "", waiting, [is_for](const SignalView& view, std::size_t row) {
    return static_cast<double>(std::count_if(view.state.waits.begin(), view.state.waits.end(),
                                             [&](const RobotWait& wait) { return is_for(view, row, wait); }));
  });
  table.AddNumber("longest_wait", "s", longest, [is_for](const SignalView& view, std::size_t row) {
    double seconds = 0.0;
    for (const RobotWait& wait : view.state.waits) {
      if (is_for(view, row, wait)) seconds = std::max(seconds, SecondsOf(view, wait));
    }
    return seconds;
  });
}

}  // namespace

void AddWaitSignals(StateTable& table) {
  if (table.name == "robots") AddOfWaitingRobots(table);
  if (table.name == "doors") {
    AddOfPlaces(table, "robots on their ways that wait for it", "the longest wait of these robots",
                [](const SignalView& view, std::size_t row, const RobotWait& wait) {
                  return wait.thing == view.world.doors[row].model;
                });
  }
  if (table.name == "lifts") {
    AddOfPlaces(table, "robots on their ways that wait for it", "the longest wait of these robots",
                [](const SignalView& view, std::size_t row, const RobotWait& wait) {
                  return wait.thing == view.world.lifts[row].model;
                });
  }
  if (table.name == "lanes") {
    AddOfPlaces(table, "robots that cannot go on along it or into it", "the longest wait of these robots",
                [](const SignalView& view, std::size_t row, const RobotWait& wait) {
                  const LaneRow& lane = view.things.lanes()[row];
                  return wait.lane && std::any_of(lane.lane.parts.begin(), lane.lane.parts.end(),
                                                  [&](std::uint32_t part) { return lane.first + part == *wait.lane; });
                });
  }
}

}  // namespace troupe
