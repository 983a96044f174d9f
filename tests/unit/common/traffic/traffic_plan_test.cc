#include "common/traffic/traffic_plan.h"

#include <gmock/gmock.h>

#include <deque>
#include <set>

#include "common/traffic/traffic_search.h"
#include "common/traffic/traffic_ways.h"
#include "tests/unit/common/traffic/traffic_world.h"

namespace troupe {
namespace {

using Goals = std::vector<std::vector<std::uint32_t>>;  // by robot: one after another, again and again

// Each robot begins at the last of its goals.
void ExpectAllArrive(const LaneGraph& lanes, const Goals& goals, std::size_t arrivals, Tick ticks) {
  TrafficRun run({lanes}, 1);
  for (const std::vector<std::uint32_t>& its : goals) run.Place(its.back());
  while (run.tick < ticks) {
    run.RunTick([&](std::size_t robot) {
      return std::optional(goals[robot][run.robots[robot].arrivals % goals[robot].size()]);
    });
    ASSERT_FALSE(::testing::Test::HasFatalFailure());
  }
  for (const TrafficRun::Robot& robot : run.robots) EXPECT_GE(robot.arrivals, arrivals);
}

TEST(TrafficPlanTest, RobotsPassAJunction) {
  LaneDraft draft;
  const std::uint32_t a = draft.Add(6, 2);
  const std::uint32_t b = draft.Add(2, 6);
  const std::uint32_t junction = draft.Add(6, 6);
  const std::uint32_t c = draft.Add(10, 10);
  const std::uint32_t d = draft.Add(14, 14);
  for (const std::uint32_t end : {a, b, c}) draft.Join(end, junction);
  draft.Join(c, d);
  ExpectAllArrive(draft.graph, {{d, a}, {c, b}}, 10, 2000);
}

TEST(TrafficPlanTest, RobotsMergeAndExchangeTheirEnds) {
  LaneDraft draft;
  const std::uint32_t right = draft.Add(0, 0);
  const std::uint32_t charger_1 = draft.Add(3, -2);
  const std::uint32_t charger_2 = draft.Add(3, 2);
  const std::uint32_t left = draft.Add(-10, 0);
  const std::uint32_t goal_1 = draft.Add(-13, -2);
  const std::uint32_t goal_2 = draft.Add(-13, 2);
  draft.Join(charger_1, right);
  draft.Join(charger_2, right);
  draft.Join(right, left);
  draft.Join(left, goal_1);
  draft.Join(left, goal_2);
  ExpectAllArrive(draft.graph, {{goal_1, charger_1}, {goal_2, charger_2}}, 10, 2000);
}

TEST(TrafficPlanTest, RobotsTakeTurnsAtADockInADeadEnd) {
  LaneDraft draft;
  const std::uint32_t dock = draft.Add(10, 2, "dock");
  const std::uint32_t gate = draft.Add(10, 6);
  std::vector<std::uint32_t> homes;
  draft.Join(dock, gate);
  for (const Vec2& home : {Vec2(4, 9), Vec2(16, 9), Vec2(10, 10)}) {
    homes.push_back(draft.Add(home.x(), home.y()));
    draft.Join(gate, homes.back());
  }
  ExpectAllArrive(draft.graph, {{dock, homes[0]}, {dock, homes[1]}, {dock, homes[2]}}, 10, 4000);
}

TEST(TrafficPlanTest, RobotsPassEachOtherAtASiding) {
  for (const bool has_siding : {true, false}) {
    LaneDraft draft;
    for (int i = 0; i < 5; ++i) draft.Add(5.0 * i, 0.0);
    for (std::uint32_t i = 0; i + 1 < 5; ++i) draft.Join(i, i + 1);
    const std::uint32_t left = draft.Add(-3, -2);
    const std::uint32_t right = draft.Add(23, -2);
    draft.Join(left, 0);
    draft.Join(right, 4);
    // The only place to pass: in the middle, or at one end.
    const std::uint32_t siding = has_siding ? draft.Add(10, 2) : draft.Add(-3, 2);
    draft.Join(has_siding ? 2 : 0, siding);
    ExpectAllArrive(draft.graph, {{right, left}, {left, right}}, 8, 4000);
  }
}

TEST(TrafficPlanTest, RobotsMoveOnAOneWayLoopWithOneFreeVertex) {
  LaneDraft draft;
  for (int i = 0; i < 6; ++i) draft.Add(3.0 * (i < 3 ? i : 5 - i), i < 3 ? 0.0 : 3.0);
  for (std::uint32_t i = 0; i < 6; ++i) draft.Join(i, (i + 1) % 6, false);
  TrafficRun run({draft.graph}, 1);
  for (std::uint32_t i = 0; i < 5; ++i) run.Place(i);
  Draws goals(3);
  while (run.tick < 4000) {
    run.RunTick([&](std::size_t) { return std::optional(static_cast<std::uint32_t>(goals.Below(6))); });
    ASSERT_FALSE(HasFatalFailure());
  }
  for (const TrafficRun::Robot& robot : run.robots) EXPECT_GE(robot.arrivals, 5u);
}

// Graphs on which each robot can reach each vertex: grids whose lanes are all there, half full, and others with few
// robots.
TEST(TrafficPlanTest, AllArriveOnRandomGrids) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Draws draws(seed);
    const bool is_whole = draws.Chance(0.5);
    const std::size_t width = (is_whole ? 2 : 3) + draws.Below(4);
    const std::size_t height = (is_whole ? 2 : 3) + draws.Below(4);
    const LaneGraph lanes = RandomGrid(draws, width, height, is_whole ? 0.0 : 0.4);
    TrafficRun run({lanes}, seed);
    const std::size_t robots = 1 + draws.Below(is_whole ? width * height / 2 : 4);
    for (std::uint32_t i = 0; i < robots; ++i) run.Place(i);
    while (run.tick < 1500) {
      run.RunTick([&](std::size_t) { return std::optional(static_cast<std::uint32_t>(draws.Below(width * height))); });
      ASSERT_FALSE(HasFatalFailure()) << "seed " << seed;
      ASSERT_LE(run.plan.moves.size(), 64 * robots + 256);
    }
    for (const TrafficRun::Robot& robot : run.robots) {
      EXPECT_LT(run.tick - robot.since, 1000u) << "seed " << seed;
      EXPECT_GE(robot.arrivals, 1u) << "seed " << seed;
    }
  }
}

// Lanes on which something stands that takes no part: robots find out, turn back and go round.
TEST(TrafficPlanTest, AllArriveBesideLanesThatAreBlocked) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Draws draws(seed);
    const std::size_t width = 3 + draws.Below(3);
    const std::size_t height = 3 + draws.Below(3);
    const LaneGraph lanes = RandomGrid(draws, width, height, 0.0);
    TrafficRun run({lanes}, seed);
    const std::size_t robots = 1 + draws.Below(width * height / 3);
    for (std::uint32_t i = 0; i < robots; ++i) run.Place(i);
    // Between vertices with two other lanes that are free; too few to divide the grid.
    std::set<std::uint32_t> ends;
    for (std::uint32_t lane = 0; lane < run.graph.lanes() && run.impassable.size() < 2; ++lane) {
      const std::uint32_t start = run.graph.start(lane);
      const std::uint32_t end = run.graph.end(lane);
      if (!draws.Chance(0.3) || run.graph.exits(start).size() < 3 || run.graph.exits(end).size() < 3) continue;
      if (ends.contains(start) || ends.contains(end)) continue;
      ends.insert({start, end});
      run.impassable.push_back(lane);
    }
    while (run.tick < 6000) {
      run.RunTick([&](std::size_t) { return std::optional(static_cast<std::uint32_t>(draws.Below(width * height))); });
      ASSERT_FALSE(HasFatalFailure()) << "seed " << seed;
    }
    for (const TrafficRun::Robot& robot : run.robots) {
      EXPECT_LT(run.tick - robot.since, 1500u) << "seed " << seed;
      EXPECT_GE(robot.arrivals, 5u) << "seed " << seed;
    }
  }
}

// All places of one robot and of others that cannot be told apart, reached by single moves.
bool CanReach(const TrafficGraph& graph, const std::vector<std::uint32_t>& places, std::uint32_t goal) {
  const auto key = [](std::vector<std::uint32_t> all) {
    std::sort(all.begin() + 1, all.end());
    return all;
  };
  std::set<std::vector<std::uint32_t>> seen = {key(places)};
  std::deque<std::vector<std::uint32_t>> open = {key(places)};
  while (!open.empty()) {
    const std::vector<std::uint32_t> now = open.front();
    open.pop_front();
    if (now.front() == goal) return true;
    for (std::size_t i = 0; i < now.size(); ++i) {
      for (const TrafficExit& exit : graph.exits(now[i])) {
        if (std::find(now.begin(), now.end(), exit.to) != now.end()) continue;
        std::vector<std::uint32_t> next = now;
        next[i] = exit.to;
        if (seen.insert(key(next)).second) open.push_back(key(next));
      }
    }
  }
  return false;
}

TEST(TrafficPlanTest, ASearchFindsAWayIfThereIsOne) {
  std::size_t solvable = 0;
  std::size_t missed = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Draws draws(seed);
    const std::size_t width = 2 + draws.Below(3);
    const std::size_t height = 2 + draws.Below(2);
    const LaneGraph lanes = RandomGrid(draws, width, height, draws.Chance(0.3) ? 0.3 : 1.0);
    const TrafficGraph graph = GraphOf({lanes});
    std::vector<std::uint32_t> places;
    const std::size_t robots = 2 + draws.Below(width * height - 2);
    for (std::uint32_t i = 0; i < width * height; ++i) places.push_back(i);
    for (std::size_t i = places.size(); i > 1; --i) std::swap(places[i - 1], places[draws.Below(i)]);
    places.resize(robots);
    const auto goal = static_cast<std::uint32_t>(draws.Below(width * height));
    const std::vector<bool> closed(graph.lanes(), false);
    const std::vector<bool> is_fixed(robots, false);
    TrafficRoutes routes(std::make_shared<const TrafficGraph>(graph));
    routes.Begin(closed);
    const TrafficSearch search(graph, closed, routes, is_fixed);
    Formation formation(graph, places);
    search.Find(formation, 0, goal, width * height, 10.0);
    if (formation.place(0) != goal) formation.UndoTo(0);
    while (formation.place(0) != goal && search.FindAnyWay(formation, 0, goal, TrafficWays::kMaxThoroughVisits)) {
    }
    const bool found = formation.place(0) == goal;
    const bool can = CanReach(graph, places, goal);
    ASSERT_TRUE(can || !found);
    solvable += can ? 1 : 0;
    missed += can && !found ? 1 : 0;
    EXPECT_TRUE(!found || formation.place(0) == goal);
  }
  EXPECT_GT(solvable, 100u);
  EXPECT_EQ(missed, 0u);
}

TEST(TrafficPlanTest, ALostRobotIsPassedByOthers) {
  Draws draws(2);
  TrafficRun run({RandomGrid(draws, 3, 3, 0.0)}, 1);
  for (const std::uint32_t place : {0u, 2u, 5u}) run.Place(place);
  Draws goals(3);
  const auto next_goal = [&](std::size_t) { return std::optional(static_cast<std::uint32_t>(goals.Below(9))); };
  while (run.tick < 500) run.RunTick(next_goal);
  // It is lost at a vertex, which is obstructed for the others from then on.
  while (run.robots[0].moves) run.RunTick(next_goal);
  run.robots[0].is_lost = true;
  const std::uint32_t lost_at = run.robots[0].at;
  for (const TrafficExit& exit : run.graph.exits(lost_at)) run.obstructed[exit.lane] = true;
  for (TrafficRun::Robot& robot : run.robots) {
    robot.goal.reset();
    robot.holds = 0;
  }
  const std::vector<TrafficRun::Robot> before = run.robots;
  const auto other_goal = [&](std::size_t) {
    auto goal = static_cast<std::uint32_t>(goals.Below(9));
    if (goal == lost_at) goal = (goal + 1) % 9;
    return std::optional(goal);
  };
  for (int i = 0; i < 2000; ++i) {
    run.RunTick(other_goal);
    ASSERT_FALSE(HasFatalFailure());
  }
  for (const std::size_t robot : {1, 2}) EXPECT_GT(run.robots[robot].arrivals, before[robot].arrivals + 20);
}

TEST(TrafficPlanTest, ABlockedRobotTurnsBackAndGoesRound) {
  LaneDraft draft;
  for (const Vec2& place : {Vec2(0, 0), Vec2(5, 0), Vec2(0, 5), Vec2(5, 5)}) draft.Add(place.x(), place.y());
  draft.Join(0, 1);
  draft.Join(0, 2);
  draft.Join(2, 3);
  draft.Join(3, 1);
  TrafficRoutes routes(std::make_shared<const TrafficGraph>(GraphOf({draft.graph})));
  const std::vector<bool> obstructed(4, false);
  TrafficPlan plan;
  TrafficRequest request{.robot = RobotId(0), .at = 0, .goal = 1};
  PlanTraffic(routes, std::span(&request, 1), obstructed, 1, plan);
  ASSERT_EQ(plan.moves.size(), 1u);
  EXPECT_EQ(plan.moves[0], (TrafficMove{RobotId(0), 0, 1, true}));
  request.is_blocked = true;
  request.driven = 2.0;
  PlanTraffic(routes, std::span(&request, 1), obstructed, 2, plan);
  request.is_blocked = false;
  request.driven = 0.0;
  EXPECT_EQ(plan.closures, (std::vector<LaneClosure>{{0, 2 + kClosedTicks, kClosedTicks}}));
  for (const std::uint32_t end : {0u, 2u, 3u, 1u}) {
    ASSERT_FALSE(plan.moves.empty());
    EXPECT_EQ(plan.moves[0].to, end);
    EXPECT_TRUE(plan.moves[0].granted);
    ++request.finished;
    PlanTraffic(routes, std::span(&request, 1), obstructed, 3, plan);
  }
  EXPECT_TRUE(plan.moves.empty());
  // The lane opens again, and is closed for twice as long if the body is still there; a robot that has passed it ends
  // that.
  request.goal = 0;
  PlanTraffic(routes, std::span(&request, 1), obstructed, 2 + kClosedTicks, plan);
  ASSERT_EQ(plan.moves.size(), 1u);
  EXPECT_EQ(plan.moves[0].lane, 0u);
  request.is_blocked = true;
  PlanTraffic(routes, std::span(&request, 1), obstructed, 1000, plan);
  EXPECT_EQ(plan.closures, (std::vector<LaneClosure>{{0, 1000 + 2 * kClosedTicks, 2 * kClosedTicks}}));
  request.is_blocked = false;
  for (int i = 0; i < 4; ++i) {  // back, and round
    ++request.finished;
    PlanTraffic(routes, std::span(&request, 1), obstructed, 3000, plan);
  }
  EXPECT_EQ(plan.robots[0].at, 0u);
  request.goal = 1;
  PlanTraffic(routes, std::span(&request, 1), obstructed, 3001, plan);
  ++request.finished;
  PlanTraffic(routes, std::span(&request, 1), obstructed, 3002, plan);
  EXPECT_EQ(plan.robots[0].at, 1u);
  EXPECT_TRUE(plan.closures.empty());
}

// Two robots in a row, of which the first one is blocked after the second one was let to where it came from.
TEST(TrafficPlanTest, ABlockedRobotTurnsBackOnceNoOtherIsBehindIt) {
  TrafficRoutes routes(std::make_shared<const TrafficGraph>(GraphOf({Chain(4, 5.0)})));
  const std::vector<bool> obstructed(3, false);
  TrafficPlan plan;
  std::vector<TrafficRequest> requests = {{.robot = RobotId(0), .at = 1, .goal = 2},
                                          {.robot = RobotId(1), .at = 0, .goal = 1}};
  PlanTraffic(routes, requests, obstructed, 1, plan);
  ASSERT_EQ(plan.moves.size(), 2u);
  EXPECT_TRUE(plan.moves[0].granted);
  EXPECT_FALSE(plan.moves[1].granted) << "the first robot may still be at the vertex";
  requests[0].driven = 2.0;
  PlanTraffic(routes, requests, obstructed, 2, plan);
  ASSERT_EQ(plan.moves.size(), 2u);
  EXPECT_TRUE(plan.moves[1].granted);
  requests[0].is_blocked = true;
  PlanTraffic(routes, requests, obstructed, 3, plan);
  ASSERT_FALSE(plan.moves.empty());
  EXPECT_EQ(plan.moves[0].to, 2u) << "there is another robot behind it";
  // It has to make room, though its own way leads on.
  requests[1].finished = 1;
  requests[1].goal = 3;
  PlanTraffic(routes, requests, obstructed, 4, plan);
  ASSERT_EQ(plan.moves.size(), 2u);
  EXPECT_EQ(plan.moves[0].to, 2u);
  EXPECT_EQ(plan.moves[1], (TrafficMove{RobotId(1), 0, 0, true}));
  requests[1].finished = 2;
  PlanTraffic(routes, requests, obstructed, 5, plan);
  EXPECT_EQ(plan.moves[0], (TrafficMove{RobotId(0), 1, 1, true}));
}

TEST(TrafficPlanTest, ARobotStartsToTakePartWhereNoOtherIs) {
  LaneDraft draft;
  for (int i = 0; i < 3; ++i) draft.Add(3.0 * i, 0.0);
  draft.Join(0, 1);
  draft.Join(1, 2);
  TrafficRoutes routes(std::make_shared<const TrafficGraph>(GraphOf({draft.graph})));
  const std::vector<bool> obstructed(2, false);
  TrafficPlan plan;
  std::vector<TrafficRequest> requests = {{.robot = RobotId(0), .at = 1}, {.robot = RobotId(4), .at = 1, .goal = 2}};
  PlanTraffic(routes, requests, obstructed, 1, plan);
  ASSERT_EQ(plan.robots.size(), 1u);
  requests[0].goal = 0;
  PlanTraffic(routes, requests, obstructed, 2, plan);
  requests[0].finished = 1;
  PlanTraffic(routes, requests, obstructed, 3, plan);
  ASSERT_EQ(plan.robots.size(), 2u);
  EXPECT_EQ(plan.robots[0].at, 0u);
  EXPECT_EQ(plan.robots[1].at, 1u);
  EXPECT_EQ(plan.robots[0].arrivals, 1u);
  EXPECT_EQ(plan.robots[1].arrivals, 0u);
  // Without requests it stays in the way of others for a while.
  for (Tick tick = 4; tick < 4 + kMaxAbsent; ++tick) {
    PlanTraffic(routes, std::span(requests).first(1), obstructed, tick, plan);
    ASSERT_EQ(plan.robots.size(), 2u);
    EXPECT_GT(plan.robots[1].held, 0u);
  }
  PlanTraffic(routes, std::span(requests).first(1), obstructed, 4 + kMaxAbsent, plan);
  EXPECT_EQ(plan.robots.size(), 1u);
  EXPECT_TRUE(plan.moves.empty());
}

// As they may be placed at the start.
TEST(TrafficPlanTest, ARobotDoesNotPassOneThatIsNearItsStart) {
  LaneDraft draft;
  draft.Add(0.0, 0.0);
  draft.Add(3.0, 0.0);
  draft.Add(0.4, 0.4);
  draft.Add(0.4, 3.0);
  draft.Join(0, 1);
  draft.Join(2, 3);
  TrafficRoutes routes(std::make_shared<const TrafficGraph>(GraphOf({draft.graph})));
  const std::vector<bool> obstructed(2, false);
  TrafficPlan plan;
  const std::vector<TrafficRequest> requests = {{.robot = RobotId(0), .at = 0, .goal = 1},
                                                {.robot = RobotId(1), .at = 2}};
  for (Tick tick = 1; tick < 20; ++tick) PlanTraffic(routes, requests, obstructed, tick, plan);
  ASSERT_EQ(plan.moves.size(), 2u);
  EXPECT_EQ(plan.moves[0].robot, RobotId(1));
  EXPECT_EQ(plan.moves[0].to, 3u);
  EXPECT_TRUE(plan.moves[0].granted);
  EXPECT_EQ(plan.moves[1].robot, RobotId(0));
  EXPECT_FALSE(plan.moves[1].granted);
}

TEST(TrafficPlanTest, ARobotThatWaitsNamesTheOther) {
  TrafficRoutes routes(std::make_shared<const TrafficGraph>(GraphOf({Chain(4, 5.0)})));
  const std::vector<bool> obstructed(3, false);
  TrafficPlan plan;
  std::vector<TrafficRequest> requests = {{.robot = RobotId(2), .at = 1, .goal = 3},
                                          {.robot = RobotId(5), .at = 0, .goal = 2}};
  for (Tick tick = 1; tick < 6; ++tick) PlanTraffic(routes, requests, obstructed, tick, plan);
  EXPECT_EQ(plan.robots[0].waiting, 0u);
  EXPECT_EQ(plan.robots[0].waits_for, std::nullopt);
  EXPECT_EQ(plan.robots[1].waiting, 5u);
  EXPECT_EQ(plan.robots[1].waits_for, RobotId(2));
  requests[0].driven = 2.0;
  PlanTraffic(routes, requests, obstructed, 6, plan);
  EXPECT_EQ(plan.robots[1].waiting, 0u);
  // A robot that stays on the way, and one that goes the other way.
  requests[0] = {.robot = RobotId(2), .at = 2, .holds = true, .finished = 1};
  requests[1].finished = 1;
  for (Tick tick = 7; tick < 10; ++tick) PlanTraffic(routes, requests, obstructed, tick, plan);
  EXPECT_EQ(plan.robots[1].waits_for, RobotId(2));
}

}  // namespace
}  // namespace troupe
