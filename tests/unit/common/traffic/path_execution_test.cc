#include "common/traffic/path_execution.h"

#include <gmock/gmock.h>

#include <map>

#include "tests/unit/common/traffic/traffic_world.h"

namespace troupe {
namespace {

constexpr double kCellSide = 1.3;  // m: robots on lanes beside each other are clear

LaneGraph CellGraph(std::uint32_t width, std::uint32_t height) {
  LaneDraft draft;
  for (std::uint32_t i = 0; i < width * height; ++i) draft.Add(kCellSide * (i % width), kCellSide * (i / width));
  for (std::uint32_t i = 0; i < width * height; ++i) {
    if ((i + 1) % width != 0) draft.Join(i, i + 1);
    if (i + width < width * height) draft.Join(i, i + width);
  }
  return draft.graph;
}

LaneTrip TripOf(std::size_t robot, std::vector<std::uint32_t> path, std::vector<std::uint32_t> steps) {
  return {RobotId(robot), {path.back()}, std::move(path), std::move(steps)};
}

TEST(FindConflict, NamesTwoRobotsAtOneVertex) {
  // The first one is at 1 from step 1 to step 3; the second one comes in step 3, as the first one leaves, or before.
  const LaneTrip first = TripOf(0, {0, 1, 2}, {0, 1, 3});
  EXPECT_FALSE(FindConflict(std::vector{first, TripOf(1, {3, 1}, {0, 3})}));
  const std::optional<PathConflict> early = FindConflict(std::vector{first, TripOf(1, {3, 1}, {0, 2})});
  ASSERT_TRUE(early);
  EXPECT_EQ(early->first, 0u);
  EXPECT_EQ(early->second, 1u);
  EXPECT_EQ(early->place, 1u);
  EXPECT_EQ(early->step, 2u);
  EXPECT_FALSE(early->is_swap);
}

TEST(FindConflict, NamesARobotThatStaysAtItsEnd) {
  const std::optional<PathConflict> found =
      FindConflict(std::vector{TripOf(0, {0, 1}, {0, 1}), TripOf(1, {3, 2, 1}, {0, 1, 9})});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->step, 9u);
}

TEST(FindConflict, NamesTwoRobotsThatChangePlaces) {
  const std::optional<PathConflict> swap =
      FindConflict(std::vector{TripOf(0, {0, 1}, {0, 1}), TripOf(1, {1, 0}, {0, 1})});
  ASSERT_TRUE(swap);
  EXPECT_TRUE(swap->is_swap);
  // One after another around a corner is none.
  EXPECT_FALSE(FindConflict(std::vector{TripOf(0, {0, 1}, {0, 1}), TripOf(1, {1, 2}, {0, 1})}));
}

TEST(PathScheduleTest, AMoveNeedsTheRobotBeforeItAtItsVertex) {
  const std::vector<LaneTrip> trips = {TripOf(0, {0, 1, 2}, {0, 1, 2}), TripOf(1, {3, 1}, {0, 5})};
  const PathSchedule schedule(trips);
  ASSERT_EQ(schedule.MovesOf(0), 2u);
  EXPECT_EQ(schedule.NeedOf(0, 0).trip, PathSchedule::kNone);
  EXPECT_EQ(schedule.NeedOf(1, 0).trip, 0u);
  EXPECT_EQ(schedule.NeedOf(1, 0).moves, 2u);
  EXPECT_EQ(schedule.NeedOf(1, 0).circle, PathSchedule::kNone);
}

TEST(PathScheduleTest, FindsRobotsThatGoRoundInACircle) {
  // 0 1
  // 2 3
  const std::vector<LaneTrip> trips = {TripOf(0, {0, 1}, {0, 1}), TripOf(1, {1, 3}, {0, 1}), TripOf(2, {3, 2}, {0, 1}),
                                       TripOf(3, {2, 0}, {0, 1})};
  const PathSchedule schedule(trips);
  ASSERT_EQ(schedule.NeedOf(2, 0).circle, 0u);
  EXPECT_EQ(schedule.circle(0).size(), 4u);
}

// Robots with delays of their own on random paths: as many as there are moves free of conflicts.
class RandomExecution {
 public:
  RandomExecution(std::uint32_t width, std::uint32_t height, std::size_t robots, std::uint32_t steps,
                  std::uint64_t seed)
      : draws_(seed), graphs_{CellGraph(width, height)}, graph_(graphs_, std::vector{kRadius}) {
    std::vector<std::uint32_t> cells(graph_.vertices());
    for (std::uint32_t i = 0; i < cells.size(); ++i) cells[i] = i;
    for (std::size_t i = 0; i < robots; ++i) {
      std::swap(cells[i], cells[i + draws_.Below(cells.size() - i)]);
      trips_.push_back(TripOf(i, {cells[i]}, {0}));
    }
    for (std::uint32_t step = 1; step <= steps; ++step) AddStep(width, step);
    robots_.resize(robots);
  }

  const std::vector<LaneTrip>& trips() const { return trips_; }

  // The ticks until all robots have arrived; nothing if they have not within `most`.
  std::optional<Tick> Run(Tick most, double delay) {
    const PathSchedule schedule(trips_);
    for (Tick tick = 1; tick <= most; ++tick) {
      std::vector<TrafficRequest> requests;
      for (std::size_t i = 0; i < robots_.size(); ++i) {
        Advance(i, delay);
        const Robot& robot = robots_[i];
        const double length = robot.moves ? kCellSide : 0.0;
        requests.push_back({.robot = RobotId(i),
                            .at = trips_[i].path[robot.finished],
                            .finished = robot.finished,
                            .driven = length * (1.0 - static_cast<double>(robot.left) / robot.most)});
      }
      ExecutePaths(graph_, schedule, trips_, requests, tick, plan_);
      Check();
      if (::testing::Test::HasFailure()) return std::nullopt;
      const auto has_arrived = [](const TrafficRobot& robot) { return robot.has_arrived; };
      if (std::all_of(plan_.robots.begin(), plan_.robots.end(), has_arrived)) return tick;
    }
    return std::nullopt;
  }

  // By vertex, the robots that have come there, in this order.
  std::map<std::uint32_t, std::vector<std::size_t>> order;

 private:
  struct Robot {
    std::uint32_t finished = 0;
    bool moves = false;
    int left = 0;
    int most = 1;
  };

  // Each robot wants to a random neighbour; those that meet stay. Now and then four of them go round.
  void AddStep(std::uint32_t width, std::uint32_t step) {
    std::vector<std::uint32_t> now;
    for (const LaneTrip& trip : trips_) now.push_back(trip.path.back());
    std::vector<std::uint32_t> next = now;
    for (std::size_t i = 0; i < next.size(); ++i) {
      const std::span<const TrafficExit> exits = graph_.exits(now[i]);
      if (draws_.Chance(0.7)) next[i] = exits[draws_.Below(exits.size())].to;
    }
    const auto corner = static_cast<std::uint32_t>(draws_.Below(graph_.vertices()));
    if ((corner + 1) % width != 0 && corner + width < graph_.vertices()) {
      const std::array<std::uint32_t, 5> ring = {corner, corner + 1, corner + width + 1, corner + width, corner};
      for (std::size_t i = 0; i < next.size(); ++i) {
        for (std::size_t k = 0; k < 4; ++k) next[i] = now[i] == ring[k] ? ring[k + 1] : next[i];
      }
    }
    for (bool changes = true; changes;) {
      changes = false;
      for (std::size_t a = 0; a < next.size(); ++a) {
        for (std::size_t b = 0; b < next.size(); ++b) {
          const bool meets = a != b && (next[a] == next[b] || (next[a] == now[b] && next[b] == now[a]));
          if (!meets || next[a] == now[a]) continue;
          next[a] = now[a];
          changes = true;
        }
      }
    }
    for (std::size_t i = 0; i < next.size(); ++i) {
      if (next[i] == now[i]) continue;
      trips_[i].path.push_back(next[i]);
      trips_[i].steps.push_back(step);
    }
  }

  std::size_t GrantsOf(std::size_t robot) const {
    return static_cast<std::size_t>(std::count_if(plan_.moves.begin(), plan_.moves.end(), [&](const TrafficMove& move) {
      return move.robot == RobotId(robot) && move.granted;
    }));
  }

  void Advance(std::size_t number, double delay) {
    Robot& robot = robots_[number];
    if (draws_.Chance(delay)) return;
    if (robot.moves && --robot.left > 0) return;
    std::size_t granted = GrantsOf(number);
    if (robot.moves) {
      ++robot.finished;
      --granted;
      order[trips_[number].path[robot.finished]].push_back(number);
    }
    robot.moves = granted > 0;
    if (robot.moves) robot.left = robot.most = 1 + static_cast<int>(draws_.Below(6));
  }

  // No two robots stand at one vertex or move to one, and none moves to where another one stands without a move.
  void Check() const {
    std::map<std::uint32_t, std::size_t> standing;
    std::map<std::uint32_t, std::size_t> ends;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      const LaneTrip& trip = trips_[i];
      const std::uint32_t at = trip.path[robots_[i].finished];
      const bool may_leave = GrantsOf(i) > 0;
      if (!may_leave) EXPECT_TRUE(standing.emplace(at, i).second) << "two at " << at;
      if (robots_[i].moves) EXPECT_TRUE(ends.emplace(trip.path[robots_[i].finished + 1], i).second);
    }
    for (const auto& [end, robot] : ends) {
      const auto other = standing.find(end);
      EXPECT_TRUE(other == standing.end() || other->second == robot) << "one moves to where another one stands";
    }
  }

  Draws draws_;
  std::vector<LaneGraph> graphs_;
  TrafficGraph graph_;
  std::vector<LaneTrip> trips_;
  std::vector<Robot> robots_;
  TrafficPlan plan_;
};

TEST(PathExecutionTest, RandomPathsAreFollowedInTheirOrderWhateverTheDelays) {
  std::size_t circles = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Draws draws(1000 + seed);
    const auto width = static_cast<std::uint32_t>(2 + draws.Below(6));
    const auto height = static_cast<std::uint32_t>(2 + draws.Below(6));
    const std::size_t robots = 1 + draws.Below(std::size_t{width} * height);
    RandomExecution run(width, height, robots, 30, seed);
    ASSERT_FALSE(FindConflict(run.trips())) << seed;
    const PathSchedule schedule(run.trips());
    for (std::uint32_t trip = 0; trip < run.trips().size(); ++trip) {
      for (std::size_t move = 0; move < schedule.MovesOf(trip); ++move) {
        circles += schedule.NeedOf(trip, move).circle != PathSchedule::kNone ? 1 : 0;
      }
    }
    ASSERT_TRUE(run.Run(20'000, draws.Chance(0.5) ? 0.3 : 0.0)) << "they do not arrive: " << seed;
    // The order of the plan: by the steps.
    std::map<std::uint32_t, std::map<std::uint32_t, std::size_t>> planned;
    for (std::size_t i = 0; i < run.trips().size(); ++i) {
      const LaneTrip& trip = run.trips()[i];
      for (std::size_t k = 1; k < trip.path.size(); ++k) planned[trip.path[k]][trip.steps[k]] = i;
    }
    for (const auto& [vertex, by_step] : planned) {
      std::vector<std::size_t> expected;
      for (const auto& [step, robot] : by_step) expected.push_back(robot);
      EXPECT_EQ(run.order[vertex], expected) << seed;
    }
  }
  EXPECT_GT(circles, 1000u);
}

TEST(PathExecutionTest, RobotsAfterOneThatIsLostWait) {
  const std::vector<LaneGraph> graphs = {CellGraph(4, 1)};
  const TrafficGraph graph(graphs, std::vector{kRadius});
  const std::vector<LaneTrip> trips = {TripOf(0, {1, 2, 3}, {0, 1, 2}), TripOf(1, {0, 1, 2}, {0, 1, 2})};
  const PathSchedule schedule(trips);
  TrafficPlan plan;
  const TrafficRequest second{.robot = RobotId(1), .at = 0};
  for (Tick tick = 1; tick < 500; ++tick) ExecutePaths(graph, schedule, trips, std::vector{second}, tick, plan);
  ASSERT_EQ(plan.robots.size(), 1u);
  EXPECT_THAT(plan.moves, ::testing::IsEmpty());
  EXPECT_EQ(plan.robots[0].waits_for, RobotId(0));
  // It comes, drives on, and the other one follows.
  ExecutePaths(graph, schedule, trips, std::vector{TrafficRequest{.robot = RobotId(0), .at = 1}, second}, 500, plan);
  EXPECT_EQ(plan.moves.size(), 2u);
  ExecutePaths(graph, schedule, trips, std::vector{TrafficRequest{.robot = RobotId(0), .at = 2, .finished = 1}, second},
               501, plan);
  ASSERT_EQ(plan.moves.size(), 2u);
  EXPECT_EQ(plan.moves[1].robot, RobotId(1));
}

TEST(PathExecutionTest, ARobotTakesPartAtTheVertexOfItsPathOnly) {
  const std::vector<LaneGraph> graphs = {CellGraph(4, 1)};
  const TrafficGraph graph(graphs, std::vector{kRadius});
  const std::vector<LaneTrip> trips = {TripOf(0, {1, 2}, {0, 1})};
  TrafficPlan plan;
  ExecutePaths(graph, PathSchedule(trips), trips, std::vector{TrafficRequest{.robot = RobotId(0), .at = 3}}, 1, plan);
  EXPECT_THAT(plan.robots, ::testing::IsEmpty());
  // A row of another plan is dropped.
  plan.robots.push_back({.robot = RobotId(0), .at = 3});
  plan.moves.push_back({RobotId(7), 0, 1, true});
  ExecutePaths(graph, PathSchedule(trips), trips, {}, 2, plan);
  EXPECT_THAT(plan.robots, ::testing::IsEmpty());
  EXPECT_THAT(plan.moves, ::testing::IsEmpty());
}

}  // namespace
}  // namespace troupe
