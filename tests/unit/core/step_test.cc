#include "world-service/core/step.h"

#include <gtest/gtest.h>

#include "common/model/states.h"
#include "tests/support/test_world.h"

namespace troupe {
namespace {

using test::Box;
using test::Square;
using test::TestWorld;

constexpr ZRange kBody{0.0, 0.5};

StepResult StepAll(const Scene& scene, const WorldState& state, const std::vector<Twist>& twists) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < twists.size(); ++i) proposals.push_back({RobotId(i), twists[i]});
  return Step(scene, state, proposals);
}

TEST(Step, MovesAlongTheArcOfTheTwist) {
  TestWorld test;
  test.AddRobot(Square(0.4), kBody, {1.0, 2.0, 0.0, 0.5});
  const Scene scene(test.world);
  const WorldState start = InitialState(scene);
  const Twist twist{.vx = 1.0, .vy = 0.2, .wz = 0.7};
  const StepResult result = StepAll(scene, start, {twist});
  EXPECT_EQ(result.state.tick, 1u);
  EXPECT_EQ(result.state.robots[0].X_WR, start.robots[0].X_WR * Integrate(twist, 0.1));
  EXPECT_EQ(result.state.robots[0].twist, twist);
  EXPECT_FALSE(result.state.robots[0].stalled);
  EXPECT_TRUE(result.events.empty());
}

TEST(Step, LeavesTheGivenStateAlone) {
  TestWorld test;
  test.AddRobot(Square(0.4), kBody, {});
  const Scene scene(test.world);
  const WorldState start = InitialState(scene);
  const WorldState copy = start;
  StepAll(scene, start, {{.vx = 1.0}});
  EXPECT_EQ(start, copy);
}

TEST(Step, StallsAtAWallWithOneEvent) {
  TestWorld test;
  const ModelId wall = test.AddModel(Box(0.25, -1.0, 0.26, 1.0));
  test.AddRobot(Square(0.4), kBody, {});
  const Scene scene(test.world);
  const WorldState start = InitialState(scene);
  const StepResult first = StepAll(scene, start, {{.vx = 1.0}});
  const RobotState& robot = first.state.robots[0];
  EXPECT_TRUE(robot.stalled);
  EXPECT_TRUE(robot.twist.IsZero());
  EXPECT_NEAR(robot.X_WR.x, 0.05, 1e-9);
  ASSERT_EQ(first.events.size(), 1u);
  EXPECT_EQ(first.events[0],
            (Event{.tick = 1, .type = EventType::kStallBegan, .robot = RobotId(0), .other = wall, .detail = ""}));

  const StepResult second = StepAll(scene, first.state, {{.vx = 1.0}});
  EXPECT_TRUE(second.state.robots[0].stalled);
  EXPECT_TRUE(second.events.empty());

  const StepResult third = StepAll(scene, second.state, {{.vx = -1.0}});
  EXPECT_FALSE(third.state.robots[0].stalled);
  EXPECT_NEAR(third.state.robots[0].X_WR.x, -0.05, 1e-8);
  ASSERT_EQ(third.events.size(), 1u);
  EXPECT_EQ(third.events[0].type, EventType::kStallEnded);
  EXPECT_EQ(third.events[0].other, std::nullopt);
}

TEST(Step, EndsAStallWhenTheRobotProposesToStop) {
  TestWorld test;
  test.AddModel(Box(0.2, -1.0, 0.3, 1.0));
  test.AddRobot(Square(0.4), kBody, {});
  const Scene scene(test.world);
  const StepResult stalled = StepAll(scene, InitialState(scene), {{.vx = 1.0}});
  ASSERT_TRUE(stalled.state.robots[0].stalled);
  const StepResult silent = Step(scene, stalled.state, {});
  EXPECT_TRUE(silent.state.robots[0].stalled) << "only a proposal ends a stall";
  const StepResult standing = StepAll(scene, stalled.state, {{}});
  EXPECT_FALSE(standing.state.robots[0].stalled);
  ASSERT_EQ(standing.events.size(), 1u);
  EXPECT_EQ(standing.events[0].type, EventType::kStallEnded);
}

TEST(Step, StopsARobotWithoutAProposal) {
  TestWorld test;
  test.AddRobot(Square(0.4), kBody, {});
  const Scene scene(test.world);
  const StepResult moving = StepAll(scene, InitialState(scene), {{.vx = 1.0}});
  const StepResult result = Step(scene, moving.state, {});
  EXPECT_EQ(result.state.robots[0].X_WR, moving.state.robots[0].X_WR);
  EXPECT_TRUE(result.state.robots[0].twist.IsZero());
}

TEST(Step, StallsOnTheGroundWheneverItMoves) {
  TestWorld test;
  test.AddRobot(Square(0.4), {-0.1, 0.5}, {});
  const Scene scene(test.world);
  const StepResult result = StepAll(scene, InitialState(scene), {{.vx = 1.0}});
  EXPECT_TRUE(result.state.robots[0].stalled);
  EXPECT_EQ(result.state.robots[0].X_WR, Pose{});
  ASSERT_EQ(result.events.size(), 1u);
  EXPECT_EQ(result.events[0].other, std::nullopt);
}

TEST(Step, RotatesTheOrderWithTheTick) {
  // Both robots move to the place between them; the one that moves first reaches it.
  TestWorld test;
  test.AddRobot(Square(0.4), kBody, {0.0, 0.0, 0.0, 0.0});
  test.AddRobot(Square(0.4), kBody, {0.5, 0.0, 0.0, kPi});
  const Scene scene(test.world);
  WorldState state = InitialState(scene);
  for (Tick tick : {6u, 7u}) {
    state.tick = tick;
    const StepResult result = StepAll(scene, state, {{.vx = 1.0}, {.vx = 1.0}});
    const std::size_t first = (tick + 1) % 2;
    EXPECT_FALSE(result.state.robots[first].stalled);
    EXPECT_TRUE(result.state.robots[1 - first].stalled);
    EXPECT_NEAR(result.state.robots[1 - first].X_WR.x, state.robots[1 - first].X_WR.x, 1e-9);
  }
}

TEST(Step, StopsRobotsThatCollideHeadOnWithinAMillimetre) {
  for (double speed : {0.5, 50.0}) {
    TestWorld test;
    test.AddRobot(Square(0.4), kBody, {-1.03, 0.0, 0.0, 0.0});
    test.AddRobot(Square(0.4), kBody, {1.07, 0.0, 0.0, kPi});
    const Scene scene(test.world);
    WorldState state = InitialState(scene);
    for (int tick = 0; tick < 60; ++tick) state = StepAll(scene, state, {{.vx = speed}, {.vx = speed}}).state;
    EXPECT_TRUE(state.robots[0].stalled);
    EXPECT_TRUE(state.robots[1].stalled);
    const double gap = state.robots[1].X_WR.x - state.robots[0].X_WR.x - 0.4;
    EXPECT_GE(gap, -kTouchTolerance);
    EXPECT_LE(gap, 1e-3);
  }
}

TEST(Step, GivesTheSameHashTwice) {
  TestWorld test;
  test.AddModel(Box(1.0, -1.0, 1.1, 1.0));
  test.AddRobot(Square(0.4), kBody, {});
  test.AddRobot(Square(0.3), kBody, {0.0, 1.0, 0.0, 1.0});
  const Scene scene(test.world);
  const WorldState start = InitialState(scene);
  const std::vector<Twist> twists{{.vx = 20.0, .wz = 0.1}, {.vx = -1.0, .wz = 2.0}};
  EXPECT_EQ(StateHash(StepAll(scene, start, twists).state), StateHash(StepAll(scene, start, twists).state));
}

TEST(Step, OrdersEventsByRobot) {
  TestWorld test;
  test.AddModel(Box(0.2, -1.0, 0.3, 9.0));
  for (int i = 0; i < 5; ++i) test.AddRobot(Square(0.4), kBody, {0.0, i * 1.0, 0.0, 0.0});
  const Scene scene(test.world);
  WorldState state = InitialState(scene);
  state.tick = 2;  // robot 3 moves first
  const StepResult result = StepAll(scene, state, std::vector<Twist>(5, {.vx = 1.0}));
  ASSERT_EQ(result.events.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(result.events[i].robot, RobotId(i));
}

}  // namespace
}  // namespace troupe
