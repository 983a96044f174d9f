// The planned traffic of lanes (step_workspace.h: PlanTraffic): the orders of robots that take part, the lanes on which
// other robots are, and the rows of the state, for the plan of common/traffic.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/model/lane_rules.h"
#include "common/model/lane_trips.h"
#include "common/spatial/scene.h"
#include "common/traffic/path_execution.h"
#include "common/traffic/traffic_plan.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

// A plan with a vertex or a lane that the lanes do not have begins anew: a state may come from outside.
bool HasPlaces(const WorldDescription& world, const TrafficPlan& plan) {
  const std::size_t vertices = CountVertices(world.lane_graphs);
  const auto is_out_of_order = [](const TrafficRobot& a, const TrafficRobot& b) { return a.robot >= b.robot; };
  if (std::adjacent_find(plan.robots.begin(), plan.robots.end(), is_out_of_order) != plan.robots.end()) return false;
  return std::all_of(plan.robots.begin(), plan.robots.end(), [&](const TrafficRobot& robot) {
    return robot.robot.index() < world.robots.size() && robot.at < vertices && (!robot.goal || *robot.goal < vertices);
  });
}

bool Fits(const TrafficGraph& graph, const TrafficPlan& plan) {
  const auto has_move = [&](const TrafficMove& move) {
    return move.lane < graph.lanes() && (move.to == graph.start(move.lane) || move.to == graph.end(move.lane)) &&
           FindTrafficRobot(plan.robots, move.robot) != nullptr;
  };
  const auto has_lane = [&](const LaneClosure& closure) { return closure.lane < graph.lanes(); };
  return std::all_of(plan.moves.begin(), plan.moves.end(), has_move) &&
         std::all_of(plan.closures.begin(), plan.closures.end(), has_lane);
}

// The lanes within reach of robots that take no part, or not yet, and stand: for one that drives by, no other way has
// to be planned, since each robot stops behind it.
std::vector<bool> FindObstructed(const StepWorkspace& workspace, const TrafficGraph& graph,
                                 std::span<const double> radii, const std::vector<bool>& takes_part) {
  const WorldDescription& world = workspace.world();
  std::vector<bool> obstructed(graph.lanes(), false);
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (takes_part[i] || !RobotExists(world, RobotId(i))) continue;
    if (!workspace.next.robots[i].twist.IsZero()) continue;
    const Pose& X_WR = workspace.next.robots[i].X_WR;
    const double radius = workspace.scene.body(workspace.scene.body_of(RobotId(i))).radius;
    std::size_t number = 0;
    for (std::size_t g = 0; g < world.lane_graphs.size(); ++g) {
      const LaneGraph& lanes = world.lane_graphs[g];
      for (const Lane& lane : lanes.lanes) {
        if (std::fabs(X_WR.z - lanes.vertices[lane.start].z) < kLevelGap &&
            lanes.DistanceTo(lane, X_WR.translation()) < radius + radii[g]) {
          obstructed[number] = true;
        }
        ++number;
      }
    }
  }
  return obstructed;
}

}  // namespace

void DirectTraffic(const TickOrders& orders, StepWorkspace& workspace) {
  const WorldDescription& world = workspace.world();
  WorldState& state = workspace.next;
  if (world.lane_graphs.empty() && state.traffic_robots.empty()) return;  // no order can be one of traffic
  TrafficPlan plan{std::move(state.traffic_robots), std::move(state.traffic_moves), std::move(state.lane_closures)};
  std::vector<double> radii(world.lane_graphs.size(), 0.0);
  const auto add_radius = [&](RobotId robot, std::uint32_t vertex) {
    double& radius = radii[FindVertex(world.lane_graphs, vertex)->graph];
    radius = std::max(radius, workspace.scene.body(workspace.scene.body_of(robot)).radius + kTrafficMargin);
  };
  std::vector<TrafficRequest> requests;
  orders.ForEachOfRobots<TrafficOrder>([&](RobotId robot, const TrafficOrder& order) {
    if (!requests.empty() && requests.back().robot == robot) return;  // the first one counts
    requests.push_back({robot, order.at, order.goal, order.holds, order.finished, order.driven, order.is_blocked});
    add_radius(robot, order.at);
  });
  if (requests.empty() && plan.robots.empty()) return;
  if (!HasPlaces(world, plan)) plan = {};
  std::vector<bool> takes_part(world.robots.size(), false);
  for (const TrafficRobot& robot : plan.robots) {
    takes_part[robot.robot.index()] = true;
    add_radius(robot.robot, robot.at);
  }
  const std::shared_ptr<TrafficRoutes> routes = workspace.scene.TrafficRoutesFor(radii);
  if (!Fits(routes->graph(), plan)) plan = {};
  const PathSchedule& schedule = workspace.scene.path_schedule();
  if (!schedule.empty()) {
    ExecutePaths(routes->graph(), schedule, world.lane_trips, requests, state.tick, plan);
  } else {
    std::vector<bool> obstructed = FindObstructed(workspace, routes->graph(), radii, takes_part);
    std::vector<Pose> poses;
    for (const TrafficRobot& robot : plan.robots) poses.push_back(state.robots[robot.robot.index()].X_WR);
    for (const std::uint32_t lane : ClosedLanesFor(world, state, poses, ZoneKind::kRelease)) obstructed[lane] = true;
    PlanTraffic(*routes, requests, obstructed, state.tick, plan);
  }
  state.traffic_robots = std::move(plan.robots);
  state.traffic_moves = std::move(plan.moves);
  state.lane_closures = std::move(plan.closures);
}

}  // namespace troupe
