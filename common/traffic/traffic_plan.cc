#include "common/traffic/traffic_plan.h"

#include <algorithm>
#include <utility>

#include "common/traffic/formation.h"
#include "common/traffic/traffic_ways.h"

namespace troupe {
namespace {

constexpr std::uint32_t kNone = Formation::kNone;

// The order of rows and requests, which ascend by robot.
constexpr auto kIsBefore = [](const auto& a, RobotId robot) { return a.robot < robot; };

// Whether two ascending lists have a number in common.
bool Meet(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

// Lanes and groups that earlier moves of the plan need.
class Claims {
 public:
  explicit Claims(const TrafficGraph& graph)
      : graph_(graph), of_lanes_(graph.lanes()), near_lanes_(graph.lanes()), of_groups_(graph.groups()) {}

  // The row of another robot that needs what a move along a lane needs.
  std::optional<std::uint32_t> FindOther(std::uint32_t row, std::uint32_t lane) const {
    if (const auto other = near_lanes_[lane].Except(row)) return other;
    for (const std::uint32_t near : graph_.LanesNearLane(lane)) {
      if (const auto other = of_lanes_[near].Except(row)) return other;
    }
    for (const std::uint32_t group : graph_.GroupsOfLane(lane)) {
      if (const auto other = of_groups_[group].Except(row)) return other;
    }
    return std::nullopt;
  }

  void Add(std::uint32_t row, std::uint32_t lane) {
    of_lanes_[lane].Add(row);
    for (const std::uint32_t group : graph_.GroupsOfLane(lane)) of_groups_[group].Add(row);
  }
  // Of a move whose start the robot has left.
  void AddRest(std::uint32_t row, std::uint32_t lane, std::uint32_t to) {
    for (const std::uint32_t near : graph_.LanesNearRest(lane, to)) near_lanes_[near].Add(row);
    for (const std::uint32_t group : graph_.GroupsOfRest(lane, to)) of_groups_[group].Add(row);
  }

 private:
  // The first two rows are enough to tell whether there is another one than any row.
  struct Owners {
    std::uint32_t first = kNone;
    std::uint32_t second = kNone;
    void Add(std::uint32_t row) {
      if (first == kNone) first = row;
      if (second == kNone && first != row) second = row;
    }
    std::optional<std::uint32_t> Except(std::uint32_t row) const {
      const std::uint32_t other = first == row ? second : first;
      return other == kNone ? std::nullopt : std::optional(other);
    }
  };

  const TrafficGraph& graph_;
  std::vector<Owners> of_lanes_;    // by lane: a move along it
  std::vector<Owners> near_lanes_;  // by lane: the rest of a move near it
  std::vector<Owners> of_groups_;
};

class Planner {
 public:
  Planner(TrafficRoutes& routes, const std::vector<bool>& obstructed, Tick tick, TrafficPlan& plan)
      : routes_(routes),
        graph_(routes.graph()),
        obstructed_(obstructed),
        tick_(tick),
        plan_(plan),
        closed_(graph_.lanes(), false) {}

  void Update(std::span<const TrafficRequest> requests) {
    NumberRows();
    RemoveAbsent(requests);
    FindPresentMoves();
    for (const TrafficRequest& request : requests) {
      const std::optional<std::uint32_t> row = RowOf(request.robot);
      if (row) Report(*row, request);
    }
    RemoveMade();
    for (const TrafficRequest& request : requests) {
      const std::optional<std::uint32_t> row = request.is_blocked ? RowOf(request.robot) : std::nullopt;
      if (row) TurnBack(plan_.robots[*row]);
    }
    for (const TrafficRequest& request : requests) {
      if (!RowOf(request.robot)) Admit(request);
    }
    NumberRows();
    for (const LaneClosure& closure : plan_.closures) closed_[closure.lane] = closure.until > tick_;
    routes_.Begin(closed_);
    for (std::size_t lane = 0; lane < closed_.size(); ++lane) closed_[lane] = closed_[lane] || obstructed_[lane];
    CountArrivals();
    PlanWays();
    Grant();
  }

 private:
  std::optional<std::uint32_t> RowOf(RobotId robot) const {
    const std::uint32_t row = robot.index() < rows_.size() ? rows_[robot.index()] : kNone;
    return row == kNone ? std::nullopt : std::optional(row);
  }

  void NumberRows() {
    rows_.assign(plan_.robots.empty() ? 0 : plan_.robots.back().robot.index() + 1, kNone);
    for (std::uint32_t row = 0; row < plan_.robots.size(); ++row) rows_[plan_.robots[row].robot.index()] = row;
  }

  // The present move of a robot: its first one in the plan; the end without one.
  std::vector<TrafficMove>::iterator FindPresent(RobotId robot) const { return FindMove(robot, plan_.moves.begin()); }
  std::vector<TrafficMove>::iterator FindMove(RobotId robot, std::vector<TrafficMove>::iterator begin) const {
    return std::find_if(begin, plan_.moves.end(), [&](const TrafficMove& move) { return move.robot == robot; });
  }

  void FindPresentMoves() {
    present_.assign(plan_.robots.size(), plan_.moves.end());
    is_made_.assign(plan_.moves.size(), false);
    for (auto move = plan_.moves.begin(); move != plan_.moves.end(); ++move) {
      const std::optional<std::uint32_t> row = RowOf(move->robot);
      if (row && present_[*row] == plan_.moves.end()) present_[*row] = move;
    }
  }

  void RemoveMade() {
    auto is_made = is_made_.begin();
    std::erase_if(plan_.moves, [&](const TrafficMove&) { return *is_made++; });
    present_.clear();
  }

  void RemoveAbsent(std::span<const TrafficRequest> requests) {
    for (TrafficRobot& robot : plan_.robots) {
      const auto found = std::lower_bound(requests.begin(), requests.end(), robot.robot, kIsBefore);
      const bool is_absent = found == requests.end() || found->robot != robot.robot;
      robot.absent = is_absent ? robot.absent + 1 : 0;
      if (is_absent) ++robot.held;
    }
    if (std::erase_if(plan_.robots, [](const TrafficRobot& robot) { return robot.absent > kMaxAbsent; }) == 0) return;
    NumberRows();
    std::erase_if(plan_.moves, [this](const TrafficMove& move) { return !RowOf(move.robot); });
  }

  void Report(std::uint32_t row, const TrafficRequest& request) {
    TrafficRobot& robot = plan_.robots[row];
    std::vector<TrafficMove>::iterator& present = present_[row];
    while (robot.finished != request.finished) {
      if (present == plan_.moves.end() || !present->granted) break;  // a report of a move that it does not have
      if (present->to != robot.at && IsKnown(present->lane)) plan_.closures.erase(FindClosure(present->lane));
      robot.at = present->to;
      robot.has_left = false;
      ++robot.finished;
      is_made_[static_cast<std::size_t>(present - plan_.moves.begin())] = true;
      present = FindMove(robot.robot, present + 1);
    }
    robot.finished = request.finished;
    robot.held = request.holds ? robot.held + 1 : 0;
    // Where something was in the way before, it may have to turn back.
    if (present != plan_.moves.end() && present->granted && present->to != robot.at && !IsKnown(present->lane)) {
      robot.has_left = robot.has_left || request.driven >= graph_.leave_distance(present->lane);
    }
    if (robot.goal != request.goal) {
      robot.goal = request.goal;
      robot.since = tick_;
      robot.has_arrived = false;
    }
  }

  void CountArrivals() {
    for (TrafficRobot& robot : plan_.robots) {
      if (robot.goal != robot.at || robot.has_arrived) continue;
      robot.has_arrived = true;
      ++robot.arrivals;
    }
  }

  // The lane is closed for a while, and the robot goes back to where its present move began, once no other one is
  // there.
  void TurnBack(TrafficRobot& robot) {
    const auto is_own = [&](const TrafficMove& move) { return move.robot == robot.robot; };
    const auto front = FindPresent(robot.robot);
    if (front == plan_.moves.end() || !front->granted || front->to == robot.at) return;
    Close(front->lane);
    plan_.moves.erase(std::remove_if(front + 1, plan_.moves.end(), is_own), plan_.moves.end());
    if (robot.has_left && !IsStartFree(robot, front->lane)) {
      // Others leave out where it stands, and those behind it make room.
      for (const std::uint32_t near : graph_.LanesNearRest(front->lane, front->to)) obstructed_[near] = true;
      stuck_.push_back({robot.robot, robot.at, front->lane});
      return;
    }
    front->to = robot.at;
    robot.has_left = false;
  }

  void Close(std::uint32_t lane) {
    const auto place = FindClosure(lane);
    const bool is_known = IsKnown(lane);
    if (is_known && place->until > tick_) return;
    const std::uint32_t ticks = is_known ? std::min(2 * place->ticks, kMaxClosedTicks) : kClosedTicks;
    const LaneClosure closure{lane, tick_ + ticks, ticks};
    if (is_known) {
      *place = closure;
    } else {
      plan_.closures.insert(place, closure);
    }
  }

  bool IsKnown(std::uint32_t lane) {
    const auto place = FindClosure(lane);
    return place != plan_.closures.end() && place->lane == lane;
  }

  // The first one that is not of a lane before it.
  std::vector<LaneClosure>::iterator FindClosure(std::uint32_t lane) {
    return std::lower_bound(plan_.closures.begin(), plan_.closures.end(), lane,
                            [](const LaneClosure& closure, std::uint32_t other) { return closure.lane < other; });
  }

  // Of a robot on a lane that it has left the start of.
  bool IsStartFree(const TrafficRobot& robot, std::uint32_t lane) const {
    const auto vertices = graph_.VerticesNearVertex(robot.at);
    const auto groups = graph_.GroupsOfLane(lane);
    return std::none_of(plan_.robots.begin(), plan_.robots.end(),
                        [&](const TrafficRobot& other) {
                          return other.robot != robot.robot && !other.has_left &&
                                 (std::binary_search(vertices.begin(), vertices.end(), other.at) ||
                                  Meet(groups, graph_.GroupsOfVertex(other.at)));
                        }) &&
           std::none_of(plan_.moves.begin(), plan_.moves.end(), [&](const TrafficMove& move) {
             if (move.robot == robot.robot || !move.granted) return false;
             const bool has_left = HasLeftStartOf(move);
             const auto its_lanes =
                 has_left ? graph_.LanesNearRest(move.lane, move.to) : graph_.LanesNearLane(move.lane);
             const auto its_groups =
                 has_left ? graph_.GroupsOfRest(move.lane, move.to) : graph_.GroupsOfLane(move.lane);
             return std::binary_search(its_lanes.begin(), its_lanes.end(), lane) || Meet(groups, its_groups);
           });
  }

  // Whether it is the present move of a robot that is clear of its start.
  bool HasLeftStartOf(const TrafficMove& move) const {
    return plan_.robots[*RowOf(move.robot)].has_left && &*FindPresent(move.robot) == &move;
  }

  // A robot that takes part from now on, unless another one is there, or moves there.
  void Admit(const TrafficRequest& request) {
    const auto is_there = [&](const TrafficRobot& robot) { return robot.at == request.at; };
    if (std::any_of(plan_.robots.begin(), plan_.robots.end(), is_there)) return;
    const auto groups = graph_.GroupsOfVertex(request.at);
    for (const TrafficMove& move : plan_.moves) {
      const auto near = graph_.VerticesNearLane(move.lane);
      const bool meets =
          std::binary_search(near.begin(), near.end(), request.at) || Meet(groups, graph_.GroupsOfLane(move.lane));
      if (meets && move.granted) return;
    }
    const auto place = std::lower_bound(plan_.robots.begin(), plan_.robots.end(), request.robot, kIsBefore);
    plan_.robots.insert(place, {.robot = request.robot,
                                .at = request.at,
                                .goal = request.goal,
                                .since = tick_,
                                .held = request.holds ? 1U : 0U,
                                .finished = request.finished});
  }

  // It stays longer than robots usually do at their goals, or cannot move.
  bool IsFixed(const TrafficRobot& robot) const {
    return robot.held > kMaxHeld || robot.absent > 0 ||
           std::any_of(stuck_.begin(), stuck_.end(), [&](const Stuck& stuck) { return stuck.robot == robot.robot; });
  }

  void PlanWays() {
    std::vector<bool> is_fixed;
    std::vector<std::uint32_t> at;
    for (const TrafficRobot& robot : plan_.robots) {
      is_fixed.push_back(IsFixed(robot));
      at.push_back(robot.at);
    }
    // Moves that have been granted depend on none that have not.
    std::vector<RowMove> granted;
    std::vector<RowMove> moves;
    for (const TrafficMove& move : plan_.moves) {
      const std::uint32_t row = *RowOf(move.robot);
      (move.granted ? granted : moves).push_back({row, move.lane, at[row], move.to});
      at[row] = move.to;
    }
    TrafficWays ways(routes_, closed_, plan_.robots, is_fixed, granted, std::move(moves));
    ways.KeepPossible();
    for (const Stuck& stuck : stuck_) ways.MakeRoom(stuck.at, stuck.lane);
    ways.Plan(tick_);
    std::erase_if(plan_.moves, [](const TrafficMove& move) { return !move.granted; });
    for (const RowMove& move : ways.moves()) {
      plan_.moves.push_back({plan_.robots[move.row].robot, move.lane, move.to, false});
    }
    waits_for_ = ways.FindBlockers();
  }

  void Grant() {
    Claims claims(graph_);
    std::vector<std::size_t> granted(plan_.robots.size(), 0);
    std::vector<bool> waits(plan_.robots.size(), false);
    for (TrafficMove& move : plan_.moves) {
      const std::uint32_t row = *RowOf(move.robot);
      // The present move of a robot is its first one in the plan.
      const bool is_present = granted[row] == 0 && !waits[row];
      if (!move.granted && !waits[row] && granted[row] < kMaxGrants && !IsAtGoal(plan_.robots[row]) &&
          !obstructed_[move.lane]) {
        const std::optional<std::uint32_t> other = claims.FindOther(row, move.lane);
        move.granted = !other;
        if (is_present && other) waits_for_[row] = other;
      }
      if (move.granted) ++granted[row];
      // It rests at its goal before it makes room for others.
      const bool arrives = !plan_.robots[row].has_arrived && plan_.robots[row].goal == move.to;
      waits[row] = waits[row] || !move.granted || arrives;
      if (is_present && plan_.robots[row].has_left) {
        claims.AddRest(row, move.lane, move.to);
      } else {
        claims.Add(row, move.lane);
      }
    }
    // Those that are granted come first, so that a robot finds its own without a look at all others.
    std::stable_partition(plan_.moves.begin(), plan_.moves.end(), [](const TrafficMove& move) { return move.granted; });
    for (std::uint32_t row = 0; row < plan_.robots.size(); ++row) CountWait(plan_.robots[row], row, granted[row] > 0);
  }

  void CountWait(TrafficRobot& robot, std::uint32_t row, bool is_on_way) const {
    const bool waits = robot.goal && robot.held == 0 && !is_on_way && robot.at != *robot.goal;
    robot.waiting = waits ? robot.waiting + 1 : 0;
    robot.waits_for.reset();
    if (waits && waits_for_[row]) robot.waits_for = plan_.robots[*waits_for_[row]].robot;
  }

  TrafficRoutes& routes_;
  const TrafficGraph& graph_;
  std::vector<bool> obstructed_;
  Tick tick_;
  TrafficPlan& plan_;
  std::vector<bool> closed_;
  std::vector<std::uint32_t> rows_ = {};                          // by robot; kNone for one that takes no part
  std::vector<std::vector<TrafficMove>::iterator> present_ = {};  // by row, of a robot that reports
  std::vector<bool> is_made_ = {};                                // by move
  std::vector<std::optional<std::uint32_t>> waits_for_ = {};      // by row
  struct Stuck {
    RobotId robot;
    std::uint32_t at = 0;
    std::uint32_t lane = 0;
  };
  std::vector<Stuck> stuck_;  // robots that cannot turn back yet
};

}  // namespace

void PlanTraffic(TrafficRoutes& routes, std::span<const TrafficRequest> requests, const std::vector<bool>& obstructed,
                 Tick tick, TrafficPlan& plan) {
  Planner(routes, obstructed, tick, plan).Update(requests);
}

}  // namespace troupe
