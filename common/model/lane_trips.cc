#include "common/model/lane_trips.h"

#include <algorithm>

namespace troupe {
namespace {

bool IsDone(const LaneTrip& trip, const WorldState& state) {
  const TrafficRobot* const robot = FindTrafficRobot(state.traffic_robots, trip.robot);
  if (robot == nullptr) return false;
  if (!trip.path.empty()) return robot->has_arrived && robot->finished + 1 == trip.path.size();
  return trip.goals.empty() || (!robot->goal && robot->at == trip.goals.back());
}

}  // namespace

const TrafficRobot* FindTrafficRobot(std::span<const TrafficRobot> rows, RobotId robot) {
  const auto row =
      std::lower_bound(rows.begin(), rows.end(), robot, [](const TrafficRobot& a, RobotId b) { return a.robot < b; });
  return row != rows.end() && row->robot == robot ? &*row : nullptr;
}

bool AreTripsDone(const WorldDescription& world, const WorldState& state) {
  return !world.lane_trips.empty() &&
         std::all_of(world.lane_trips.begin(), world.lane_trips.end(),
                     [&](const LaneTrip& trip) { return !RobotExists(world, trip.robot) || IsDone(trip, state); });
}

}  // namespace troupe
