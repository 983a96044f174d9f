#include "common/traffic/path_execution.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace troupe {
namespace {

class PathExecution {
 public:
  PathExecution(const TrafficGraph& graph, const PathSchedule& schedule, std::span<const LaneTrip> trips,
                TrafficPlan& plan)
      : graph_(graph), schedule_(schedule), trips_(trips), plan_(plan), row_of_(trips.size(), PathSchedule::kNone) {}

  void Update(std::span<const TrafficRequest> requests, Tick tick) {
    DropUnknown();
    CountGrants();
    for (TrafficRobot& robot : plan_.robots) ++robot.absent;
    for (const TrafficRequest& request : requests) {
      const std::uint32_t trip = schedule_.TripOf(request.robot);
      if (trip != PathSchedule::kNone && row_of_[trip] != PathSchedule::kNone) Report(trip, request);
    }
    for (const TrafficRequest& request : requests) {
      const std::uint32_t trip = schedule_.TripOf(request.robot);
      if (trip != PathSchedule::kNone && row_of_[trip] == PathSchedule::kNone) Admit(trip, request, tick);
    }
    FindRows();
    Grant();
  }

 private:
  static bool IsBefore(const TrafficRobot& row, RobotId robot) { return row.robot < robot; }

  // A state may come from outside: rows that no path has made.
  void DropUnknown() {
    std::erase_if(plan_.robots, [this](const TrafficRobot& robot) {
      const std::uint32_t trip = schedule_.TripOf(robot.robot);
      return trip == PathSchedule::kNone || robot.finished > schedule_.MovesOf(trip) ||
             trips_[trip].path[robot.finished] != robot.at;
    });
    plan_.closures.clear();
    FindRows();
  }

  void FindRows() {
    std::fill(row_of_.begin(), row_of_.end(), PathSchedule::kNone);
    for (std::uint32_t row = 0; row < plan_.robots.size(); ++row) {
      row_of_[schedule_.TripOf(plan_.robots[row].robot)] = row;
    }
  }

  void CountGrants() {
    granted_.assign(trips_.size(), 0);
    for (const TrafficRobot& robot : plan_.robots) granted_[schedule_.TripOf(robot.robot)] = robot.finished;
    for (const TrafficMove& move : plan_.moves) {
      const std::uint32_t trip = schedule_.TripOf(move.robot);
      if (trip == PathSchedule::kNone || row_of_[trip] == PathSchedule::kNone) continue;
      if (granted_[trip] < schedule_.MovesOf(trip)) ++granted_[trip];
    }
  }

  void Admit(std::uint32_t trip, const TrafficRequest& request, Tick tick) {
    if (request.finished > schedule_.MovesOf(trip) || trips_[trip].path[request.finished] != request.at) return;
    const auto place = std::lower_bound(plan_.robots.begin(), plan_.robots.end(), request.robot, IsBefore);
    plan_.robots.insert(place, {.robot = request.robot,
                                .at = request.at,
                                .goal = trips_[trip].path.back(),
                                .since = tick,
                                .finished = request.finished});
    granted_[trip] = request.finished;
  }

  void Report(std::uint32_t trip, const TrafficRequest& request) {
    TrafficRobot& robot = plan_.robots[row_of_[trip]];
    robot.absent = 0;
    robot.held = request.holds ? robot.held + 1 : 0;
    // A report of moves that it does not have has no effect.
    const std::uint32_t done = request.finished - robot.finished;
    if (done > granted_[trip] - robot.finished) return;
    if (done > 0) robot.has_left = false;
    robot.finished = request.finished;
    robot.at = trips_[trip].path[robot.finished];
    if (robot.finished < granted_[trip]) {
      const std::optional<std::uint32_t> lane = LaneOf(trip, robot.finished);
      robot.has_left = robot.has_left || (lane && request.driven >= graph_.leave_distance(*lane));
    }
  }

  // Nothing: no lane leads there.
  std::optional<std::uint32_t> LaneOf(std::uint32_t trip, std::size_t move) const {
    const std::vector<std::uint32_t>& path = trips_[trip].path;
    for (const TrafficExit& exit : graph_.exits(path[move])) {
      if (exit.to == path[move + 1]) return exit.lane;
    }
    return std::nullopt;
  }

  bool HasDone(std::uint32_t trip, std::uint32_t moves) const {
    if (row_of_[trip] == PathSchedule::kNone) return moves == 0;
    const TrafficRobot& robot = plan_.robots[row_of_[trip]];
    return robot.finished >= moves || (robot.finished + 1 == moves && robot.has_left);
  }

  // The trip whose robot is waited for; nothing: the move may begin.
  std::optional<std::uint32_t> FindBlocker(std::uint32_t trip, std::size_t move) const {
    const PathSchedule::Need& need = schedule_.NeedOf(trip, move);
    if (need.trip == PathSchedule::kNone) return std::nullopt;
    if (need.circle == PathSchedule::kNone) {
      return HasDone(need.trip, need.moves) ? std::nullopt : std::optional(need.trip);
    }
    for (const PathSchedule::CircleMove& each : schedule_.circle(need.circle)) {
      const std::uint32_t row = row_of_[each.trip];
      if (row == PathSchedule::kNone || plan_.robots[row].finished < each.move) return each.trip;
    }
    return std::nullopt;
  }

  void Grant() {
    plan_.moves.clear();
    for (TrafficRobot& robot : plan_.robots) {
      const std::uint32_t trip = schedule_.TripOf(robot.robot);
      std::uint32_t& granted = granted_[trip];
      std::optional<std::uint32_t> blocker;
      while (granted < schedule_.MovesOf(trip) && granted < robot.finished + kMaxGrants) {
        blocker = FindBlocker(trip, granted);
        if (blocker || !LaneOf(trip, granted)) break;
        ++granted;
      }
      for (std::uint32_t move = robot.finished; move < granted; ++move) {
        plan_.moves.push_back({robot.robot, *LaneOf(trip, move), trips_[trip].path[move + 1], true});
      }
      const bool is_done = robot.finished == schedule_.MovesOf(trip);
      if (is_done && !std::exchange(robot.has_arrived, true)) ++robot.arrivals;
      const bool waits = !is_done && granted == robot.finished;
      robot.waiting = waits ? robot.waiting + 1 : 0;
      robot.waits_for.reset();
      if (waits && blocker) robot.waits_for = trips_[*blocker].robot;
    }
  }

  const TrafficGraph& graph_;
  const PathSchedule& schedule_;
  std::span<const LaneTrip> trips_;
  TrafficPlan& plan_;
  std::vector<std::uint32_t> row_of_;   // by trip; kNone: it takes no part
  std::vector<std::uint32_t> granted_;  // by trip: moves, those that are done included
};

}  // namespace

void ExecutePaths(const TrafficGraph& graph, const PathSchedule& schedule, std::span<const LaneTrip> trips,
                  std::span<const TrafficRequest> requests, Tick tick, TrafficPlan& plan) {
  PathExecution(graph, schedule, trips, plan).Update(requests, tick);
}

}  // namespace troupe
