// What robots wait for (troupe/traffic_state.h: RobotWait). A robot of the planned traffic waits by the plan as long as
// it has no move that it may make: for the robot after which it goes on, for a body on its next lane, or for a closed
// lane. In front of doors, lifts, people and boxes, and without a plan, its controller says so, by a WaitOrder.
//
// A row lives as long as the robot waits, whatever for: `since` tells where the wait began.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

constexpr double kNextTo = 0.4;      // m, between a robot's body and one on its lane
constexpr Tick kTicksOfSearch = 10;  // from one search of a closed lane to the next

class WaitFinder {
 public:
  explicit WaitFinder(StepWorkspace& workspace)
      : workspace_(workspace), world_(workspace.world()), state_(workspace.next), before_(std::move(state_.waits)) {
    state_.waits.clear();
    lane_count_ = CountLanes(world_.lane_graphs);
    for (const TrafficMove& move : state_.traffic_moves) {
      if (move.robot.index() >= world_.robots.size()) continue;
      if (next_moves_.empty()) next_moves_.resize(world_.robots.size(), nullptr);
      const TrafficMove*& first = next_moves_[move.robot.index()];
      if (first == nullptr) first = &move;
    }
  }

  void Update(const TickOrders& orders) {
    auto planned = state_.traffic_robots.begin();
    const auto end = state_.traffic_robots.end();
    // Both ascend by robot.
    const auto add_planned = [&](std::optional<RobotId> before) {
      for (; planned != end && (!before || planned->robot < *before); ++planned) AddPlanned(*planned);
    };
    orders.ForEachOfRobots<WaitOrder>([&](RobotId robot, const WaitOrder& order) {
      add_planned(robot);
      const bool is_planned = planned != end && planned->robot == robot;
      if (is_planned && planned->waiting > 0) return;
      // Of a robot that has just got its next move: it goes on.
      if (is_planned && !order.thing && !order.lane) return;
      if (!state_.waits.empty() && state_.waits.back().robot == robot) return;  // the first one counts
      Add(robot, order.thing, order.lane);
    });
    add_planned(std::nullopt);
  }

 private:
  const RobotWait* Before(RobotId robot) const {
    const auto found = std::lower_bound(before_.begin(), before_.end(), robot,
                                        [](const RobotWait& wait, RobotId other) { return wait.robot < other; });
    return found != before_.end() && found->robot == robot ? &*found : nullptr;
  }

  void Add(RobotId robot, std::optional<ModelId> thing, std::optional<std::uint32_t> lane) {
    const RobotWait* const before = Before(robot);
    state_.waits.push_back({robot, before != nullptr ? before->since : state_.tick, thing, lane});
  }

  void AddPlanned(const TrafficRobot& robot) {
    if (robot.waiting == 0 || robot.robot.index() >= world_.robots.size()) return;
    const TrafficMove* const move = next_moves_.empty() ? nullptr : next_moves_[robot.robot.index()];
    std::optional<std::uint32_t> lane;
    if (move != nullptr && move->lane < lane_count_) lane = move->lane;
    if (robot.waits_for) return Add(robot.robot, world_.robot(*robot.waits_for).root, lane);
    if (lane) return Add(robot.robot, FindOnLane(robot.robot, *lane), lane);
    if (move != nullptr) return Add(robot.robot, FindLift(robot.at), std::nullopt);  // a ride
    Add(robot.robot, std::nullopt, FindClosed(robot));
  }

  // A robot that takes no part in the traffic: the planner leaves out the lanes that it is on.
  std::optional<ModelId> FindOnLane(RobotId own, std::uint32_t number) const {
    const GraphPlace place = *FindLane(world_.lane_graphs, number);
    const LaneGraph& graph = world_.lane_graphs[place.graph];
    const Lane& lane = graph.lanes[place.number];
    for (std::size_t i = 0; i < world_.robots.size(); ++i) {
      const RobotId other(i);
      if (other == own || TakesPart(other) || !RobotExists(world_, other)) continue;
      const Pose& X_WR = state_.robots[i].X_WR;
      if (std::fabs(X_WR.z - graph.vertices[lane.start].z) >= kLevelGap) continue;
      const double reach = RadiusOf(own) + RadiusOf(other) + kNextTo;
      if (graph.DistanceTo(lane, X_WR.translation()) < reach) return world_.robot(other).root;
    }
    return std::nullopt;
  }

  double RadiusOf(RobotId robot) const { return workspace_.scene.body(workspace_.scene.body_of(robot)).radius; }

  bool TakesPart(RobotId robot) const {
    const auto found = std::lower_bound(state_.traffic_robots.begin(), state_.traffic_robots.end(), robot,
                                        [](const TrafficRobot& a, RobotId b) { return a.robot < b; });
    return found != state_.traffic_robots.end() && found->robot == robot;
  }

  std::optional<ModelId> FindLift(std::uint32_t at) const {
    const std::optional<GraphPlace> place = FindVertex(world_.lane_graphs, at);
    if (!place) return std::nullopt;
    const std::optional<std::uint32_t>& lift = world_.lane_graphs[place->graph].vertices[place->number].lift;
    return lift ? std::optional(world_.lifts[*lift].model) : std::nullopt;
  }

  bool IsClosed(std::size_t lane) const {
    const auto found = std::lower_bound(state_.lane_closures.begin(), state_.lane_closures.end(), lane,
                                        [](const LaneClosure& closure, std::size_t b) { return closure.lane < b; });
    return found != state_.lane_closures.end() && found->lane == lane && found->until > state_.tick;
  }

  // Of a robot without a way: the first closed lane on the way with the fewest lanes that it would have without
  // closures.
  std::optional<std::uint32_t> FindClosed(const TrafficRobot& robot) const {
    if (state_.lane_closures.empty() || !robot.goal) return std::nullopt;
    const RobotWait* const before = Before(robot.robot);
    if (before != nullptr && before->lane && IsClosed(*before->lane)) return before->lane;
    if (before != nullptr && (state_.tick - before->since) % kTicksOfSearch != 0) return std::nullopt;
    const std::optional<GraphPlace> from = FindVertex(world_.lane_graphs, robot.at);
    const std::optional<GraphPlace> to = FindVertex(world_.lane_graphs, *robot.goal);
    if (!from || !to || from->graph != to->graph) return std::nullopt;
    return FindClosedOnWay(from->graph, from->number, to->number);
  }

  // From the goal back, so that the way is followed from its start.
  std::optional<std::uint32_t> FindClosedOnWay(std::size_t graph_number, std::size_t from, std::size_t to) const {
    const LaneGraph& graph = world_.lane_graphs[graph_number];
    const std::size_t first_lane = FirstLaneOf(world_.lane_graphs, graph);
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    struct Next {
      std::size_t vertex = kNone;
      std::size_t lane = kNone;  // none: a ride
    };
    std::vector<Next> next(graph.vertices.size());
    std::queue<std::size_t> open;
    open.push(to);
    next[to].vertex = to;
    const auto reach = [&](std::size_t vertex, std::size_t at, std::size_t lane) {
      if (next[vertex].vertex != kNone) return;
      next[vertex] = {at, lane};
      open.push(vertex);
    };
    while (!open.empty() && next[from].vertex == kNone) {
      const std::size_t at = open.front();
      open.pop();
      for (std::size_t i = 0; i < graph.lanes.size(); ++i) {
        const Lane& lane = graph.lanes[i];
        if (lane.end == at) reach(lane.start, at, i);
        if (lane.start == at && lane.is_bidirectional) reach(lane.end, at, i);
      }
      if (!graph.vertices[at].lift) continue;
      for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
        if (graph.vertices[i].lift == graph.vertices[at].lift) reach(i, at, kNone);
      }
    }
    if (next[from].vertex == kNone) return std::nullopt;
    for (std::size_t at = from; at != to; at = next[at].vertex) {
      const std::size_t lane = next[at].lane;
      if (lane != kNone && IsClosed(first_lane + lane)) return static_cast<std::uint32_t>(first_lane + lane);
    }
    return std::nullopt;
  }

  StepWorkspace& workspace_;
  const WorldDescription& world_;
  WorldState& state_;
  const std::vector<RobotWait> before_;
  std::size_t lane_count_ = 0;
  std::vector<const TrafficMove*> next_moves_;  // by robot; empty without moves
};

}  // namespace

void UpdateWaits(const TickOrders& orders, StepWorkspace& workspace) {
  WaitFinder(workspace).Update(orders);
}

}  // namespace troupe
