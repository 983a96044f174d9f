#include "common/traffic/traffic_plan.h"

#include <algorithm>
#include <utility>

#include "common/traffic/formation.h"
#include "common/traffic/traffic_search.h"

namespace troupe {
namespace {

constexpr std::uint32_t kNone = Formation::kNone;
constexpr std::size_t kMaxPending = 64;  // moves of a robot that others push

// Lanes and groups that earlier moves of the plan need: of one robot, or of several.
class Claims {
 public:
  explicit Claims(const TrafficGraph& graph)
      : graph_(graph), of_lanes_(graph.lanes(), kNone), of_groups_(graph.groups(), kNone) {}

  bool AreOfOthers(std::uint32_t row, std::uint32_t lane) const {
    const auto is_other = [&](std::uint32_t owner) { return owner != kNone && owner != row; };
    const auto lanes = graph_.LanesNearLane(lane);
    const auto groups = graph_.GroupsOfLane(lane);
    return std::any_of(lanes.begin(), lanes.end(), [&](std::uint32_t near) { return is_other(of_lanes_[near]); }) ||
           std::any_of(groups.begin(), groups.end(), [&](std::uint32_t group) { return is_other(of_groups_[group]); });
  }

  void Add(std::uint32_t row, std::uint32_t lane) {
    const auto add = [&](std::uint32_t& owner) { owner = owner == kNone || owner == row ? row : kSeveral; };
    add(of_lanes_[lane]);
    for (const std::uint32_t group : graph_.GroupsOfLane(lane)) add(of_groups_[group]);
  }

 private:
  static constexpr std::uint32_t kSeveral = kNone - 1;

  const TrafficGraph& graph_;
  std::vector<std::uint32_t> of_lanes_;
  std::vector<std::uint32_t> of_groups_;
};

class Planner {
 public:
  Planner(const TrafficGraph& graph, const std::vector<bool>& obstructed, Tick tick, TrafficPlan& plan)
      : graph_(graph), obstructed_(obstructed), tick_(tick), plan_(plan), closed_(obstructed) {}

  void Update(std::span<const TrafficRequest> requests) {
    RemoveAbsent(requests);
    for (const TrafficRequest& request : requests) {
      const std::optional<std::uint32_t> row = RowOf(request.robot);
      if (row) Report(*row, request);
    }
    if (std::erase_if(plan_.closures, [&](const LaneClosure& closure) { return closure.until <= tick_; }) > 0) {
      drops_ = true;
    }
    for (const TrafficRequest& request : requests) {
      if (!RowOf(request.robot)) Admit(request);
    }
    for (const TrafficMove& move : plan_.moves) drops_ = drops_ || (!move.granted && obstructed_[move.lane]);
    if (drops_) std::erase_if(plan_.moves, [](const TrafficMove& move) { return !move.granted; });
    for (const LaneClosure& closure : plan_.closures) closed_[closure.lane] = true;
    ExtendPlan();
    Grant();
  }

 private:
  std::optional<std::uint32_t> RowOf(RobotId robot) const {
    const auto found = std::lower_bound(plan_.robots.begin(), plan_.robots.end(), robot,
                                        [](const TrafficRobot& a, RobotId b) { return a.robot < b; });
    if (found == plan_.robots.end() || found->robot != robot) return std::nullopt;
    return static_cast<std::uint32_t>(found - plan_.robots.begin());
  }

  void RemoveAbsent(std::span<const TrafficRequest> requests) {
    const auto is_absent = [&](RobotId robot) {
      const auto found = std::lower_bound(requests.begin(), requests.end(), robot,
                                          [](const TrafficRequest& a, RobotId b) { return a.robot < b; });
      return found == requests.end() || found->robot != robot;
    };
    const auto removed = std::erase_if(plan_.robots, [&](const TrafficRobot& robot) { return is_absent(robot.robot); });
    if (removed == 0) return;
    drops_ = true;
    std::erase_if(plan_.moves, [&](const TrafficMove& move) { return is_absent(move.robot); });
  }

  void Report(std::uint32_t row, const TrafficRequest& request) {
    TrafficRobot& robot = plan_.robots[row];
    const auto is_own = [&](const TrafficMove& move) { return move.robot == robot.robot; };
    while (robot.finished != request.finished) {
      const auto front = std::find_if(plan_.moves.begin(), plan_.moves.end(), is_own);
      if (front == plan_.moves.end() || !front->granted) break;  // a report of a move that it does not have
      robot.at = front->to;
      ++robot.finished;
      plan_.moves.erase(front);
    }
    robot.finished = request.finished;
    robot.holds = request.holds;
    if (robot.goal != request.goal) {
      robot.goal = request.goal;
      robot.since = tick_;
      if (std::any_of(plan_.moves.begin(), plan_.moves.end(), is_own)) drops_ = true;
    }
    if (request.is_blocked) TurnBack(robot);
  }

  // The robot goes back to where its present move began, and the lane is closed for a while.
  void TurnBack(const TrafficRobot& robot) {
    const auto is_own = [&](const TrafficMove& move) { return move.robot == robot.robot; };
    const auto front = std::find_if(plan_.moves.begin(), plan_.moves.end(), is_own);
    if (front == plan_.moves.end() || !front->granted || front->to == robot.at) return;
    front->to = robot.at;
    drops_ = true;
    plan_.moves.erase(std::remove_if(front + 1, plan_.moves.end(), is_own), plan_.moves.end());
    const LaneClosure closure{front->lane, tick_ + kClosedTicks};
    const auto place = std::lower_bound(plan_.closures.begin(), plan_.closures.end(), closure,
                                        [](const LaneClosure& a, const LaneClosure& b) { return a.lane < b.lane; });
    if (place != plan_.closures.end() && place->lane == closure.lane) {
      *place = closure;
    } else {
      plan_.closures.insert(place, closure);
    }
  }

  // A robot that takes part from now on, unless another one is there, or moves there.
  void Admit(const TrafficRequest& request) {
    const auto is_there = [&](const TrafficRobot& robot) { return robot.at == request.at; };
    if (std::any_of(plan_.robots.begin(), plan_.robots.end(), is_there)) return;
    const auto groups = graph_.GroupsOfVertex(request.at);
    bool drops = false;
    for (const TrafficMove& move : plan_.moves) {
      const auto near = graph_.VerticesNearLane(move.lane);
      const auto shared = graph_.GroupsOfLane(move.lane);
      const bool meets = std::binary_search(near.begin(), near.end(), request.at) ||
                         std::find_first_of(groups.begin(), groups.end(), shared.begin(), shared.end()) != groups.end();
      if (meets && move.granted) return;
      drops = drops || meets;
    }
    drops_ = drops_ || drops;
    const auto place = std::lower_bound(plan_.robots.begin(), plan_.robots.end(), request.robot,
                                        [](const TrafficRobot& a, RobotId b) { return a.robot < b; });
    plan_.robots.insert(place, {.robot = request.robot,
                                .at = request.at,
                                .goal = request.goal,
                                .since = tick_,
                                .holds = request.holds,
                                .finished = request.finished});
  }

  // Where the robots will be after all moves of the plan.
  Formation AtEnd() {
    std::vector<std::uint32_t> places;
    for (const TrafficRobot& robot : plan_.robots) places.push_back(robot.at);
    pending_.assign(places.size(), 0);
    for (const TrafficMove& move : plan_.moves) {
      const std::uint32_t row = *RowOf(move.robot);
      places[row] = move.to;
      ++pending_[row];
    }
    return {graph_, std::move(places)};
  }

  void ExtendPlan() {
    Formation formation = AtEnd();
    const auto has_way = [&](std::uint32_t row) {
      const TrafficRobot& robot = plan_.robots[row];
      return robot.goal && !robot.holds && formation.place(row) != *robot.goal;
    };
    std::vector<std::uint32_t> order;
    for (std::uint32_t row = 0; row < plan_.robots.size(); ++row) {
      if (has_way(row)) order.push_back(row);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return plan_.robots[a].since < plan_.robots[b].since; });
    // By row; those without a way come after all others.
    std::vector<std::size_t> ranks(plan_.robots.size(), order.size());
    for (std::size_t i = 0; i < order.size(); ++i) ranks[order[i]] = i;
    std::vector<bool> stuck(plan_.robots.size(), false);  // without a way: all others may move it
    bool is_first = true;
    std::size_t searches = 0;
    // The others take turns, so that each searches once in a while.
    const std::size_t shift = order.size() > 1 ? (tick_ * (kMaxSearches - 1)) % (order.size() - 1) : 0;
    for (std::size_t i = 0; i < order.size() && searches < kMaxSearches; ++i) {
      const std::uint32_t row = order[i == 0 ? 0 : 1 + (i - 1 + shift) % (order.size() - 1)];
      if (!has_way(row)) continue;
      if (pending_[row] >= kMinMoves) {
        is_first = false;  // of the oldest goal
        continue;
      }
      ++searches;
      std::vector<bool> is_fixed(plan_.robots.size());
      for (std::uint32_t other = 0; other < is_fixed.size(); ++other) {
        is_fixed[other] = IsFixed(formation, other) || (ranks[other] < ranks[row] && !is_first && !stuck[other]);
      }
      stuck[row] = !Extend(formation, row, is_fixed, is_first);
      is_first = is_first && stuck[row];
    }
  }

  // It holds, will be at its goal and has to arrive there first, or has many moves to make.
  bool IsFixed(const Formation& formation, std::uint32_t row) const {
    const TrafficRobot& robot = plan_.robots[row];
    return robot.holds || robot.goal == formation.place(row) || pending_[row] >= kMaxPending;
  }

  // True if the plan has moves more.
  bool Extend(Formation& formation, std::uint32_t row, const std::vector<bool>& is_fixed, bool is_first) {
    const TrafficSearch search(graph_, closed_, is_fixed);
    const std::size_t begun = formation.moves().size();
    const std::uint32_t goal = *plan_.robots[row].goal;
    bool found = search.Find(formation, row, goal);
    const std::uint32_t there = formation.occupant(goal);
    const bool is_taken = there != kNone && is_fixed[there];
    if (!found && !is_taken && is_first && !has_searched_any_way_ &&
        (plan_.moves.empty() || tick_ % kAnyWayTicks == 0)) {
      has_searched_any_way_ = true;
      found = search.FindAnyWay(formation, row, goal);
    }
    if (!found) return false;
    if (!is_first) CutOff(formation, row, begun);
    for (std::size_t i = begun; i < formation.moves().size(); ++i) {
      const RowMove& move = formation.moves()[i];
      plan_.moves.push_back({plan_.robots[move.row].robot, move.lane, move.to, false});
      ++pending_[move.row];
    }
    return true;
  }

  // After some moves of the robot, at a vertex at which it may wait.
  void CutOff(Formation& formation, std::uint32_t row, std::size_t begun) const {
    std::size_t own = 0;
    for (std::size_t i = begun; i < formation.moves().size(); ++i) {
      const RowMove& move = formation.moves()[i];
      if (move.row != row) continue;
      if (++own >= kMaxMoves - kMinMoves && graph_.IsOpen(move.to)) return formation.UndoTo(i + 1);
    }
  }

  void Grant() {
    Claims claims(graph_);
    std::vector<std::size_t> granted(plan_.robots.size(), 0);
    std::vector<bool> waits(plan_.robots.size(), false);
    for (TrafficMove& move : plan_.moves) {
      const std::uint32_t row = *RowOf(move.robot);
      if (!move.granted && !waits[row] && granted[row] < kMaxGrants && !obstructed_[move.lane]) {
        move.granted = !claims.AreOfOthers(row, move.lane);
      }
      if (move.granted) {
        ++granted[row];
      } else {
        waits[row] = true;
      }
      claims.Add(row, move.lane);
    }
  }

  const TrafficGraph& graph_;
  const std::vector<bool>& obstructed_;
  Tick tick_;
  TrafficPlan& plan_;
  std::vector<bool> closed_;
  std::vector<std::size_t> pending_;   // moves, by row
  bool drops_ = false;                 // the moves that are not granted
  bool has_searched_any_way_ = false;  // in this tick: it is the longest search
};

}  // namespace

void PlanTraffic(const TrafficGraph& graph, std::span<const TrafficRequest> requests,
                 const std::vector<bool>& obstructed, Tick tick, TrafficPlan& plan) {
  Planner(graph, obstructed, tick, plan).Update(requests);
}

}  // namespace troupe
