#include "world-service/core/step.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "common/model/states.h"
#include "tests/support/gripper_world.h"
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

TEST(InitialState, ObjectsOnASupportRestAndThoseInTheAirStayPlaced) {
  test::GripperWorld world;
  const ModelId table = world.AddModel(test::Square(1.0), {0.6, 0.7});
  const ObjectId on_table = world.AddObject({0.0, 0.0, 0.7, 0.0});
  const ObjectId on_ground = world.AddObject({5.0, 0.0, 0.0, 0.0});
  const ObjectId in_air = world.AddObject({8.0, 0.0, 1.0, 0.0});
  const Scene scene(world.world);
  const WorldState state = InitialState(scene);
  EXPECT_EQ(state.tick, 0u);
  EXPECT_EQ(state.objects[on_table.index()].mode, ObjectMode::kResting);
  EXPECT_EQ(state.objects[on_table.index()].support, table);
  EXPECT_EQ(state.objects[on_ground.index()].mode, ObjectMode::kResting);
  EXPECT_EQ(state.objects[on_ground.index()].support, std::nullopt);
  EXPECT_EQ(state.objects[in_air.index()].mode, ObjectMode::kPlaced);
}

TEST(InitialState, HasTheHashOfTheDescriptionsPoses) {
  test::GripperWorld world;
  world.AddModel(test::Square(1.0), {0.6, 0.7});
  world.AddObject({0.0, 0.0, 0.7, 0.0});
  const Scene scene(world.world);
  WorldState state = InitialState(scene);
  EXPECT_NE(state, PlacedState(world.world));
  EXPECT_EQ(StateHash(state), StateHash(PlacedState(world.world)));
  state.tick = 1;
  WorldState unsupported = PlacedState(world.world);
  unsupported.tick = 1;
  EXPECT_NE(StateHash(state), StateHash(unsupported));
}

TEST(InitialState, AStepWithoutProposalsKeepsIt) {
  test::GripperWorld world;
  world.AddModel(test::Square(1.0), {0.6, 0.7});
  world.AddObject({0.0, 0.0, 0.7, 0.0});
  world.AddObject({5.0, 0.0, 0.0, 0.0});
  const Scene scene(world.world);
  const WorldState state = InitialState(scene);
  const StepResult next = Step(scene, state, {});
  EXPECT_EQ(next.state.objects, state.objects);
  EXPECT_TRUE(next.events.empty());
}

class ValidateProposalTest : public testing::Test {
 protected:
  ValidateProposalTest() {
    test_.AddRobot(test::Square(0.4), {0.0, 0.5}, {});
    DriveDescription& drive = test_.world.robots[0].drive;
    drive.type = DriveType::kDifferential;
    drive.velocity = {{-1.0, 1.0}, {0.0, 0.0}, {-2.0, 2.0}};
    drive.acceleration = {{-1.0, 1.0}, {0.0, 0.0}, {-10.0, 10.0}};
    state_ = PlacedState(test_.world);
    scene_.emplace(test_.world);
  }
  // The message of the error, if any.
  std::string Check(const Proposal& proposal) const {
    const Status valid = ValidateProposal(*scene_, state_, proposal);
    return valid.ok() ? "" : valid.error().message;
  }

  test::TestWorld test_;
  WorldState state_;
  std::optional<Scene> scene_;
};

TEST_F(ValidateProposalTest, AcceptsMotionsWithinTheLimits) {
  EXPECT_EQ(Check({RobotId(0), {}}), "");
  EXPECT_EQ(Check({RobotId(0), {.vx = 0.1, .wz = -1.0}}), "");
  state_.robots[0].twist = {.vx = 0.95};
  EXPECT_EQ(Check({RobotId(0), {.vx = 1.0}}), "");
}

TEST_F(ValidateProposalTest, RefusesAnUnknownRobot) {
  EXPECT_EQ(Check({RobotId(1), {}}), "found robot 1, expected one of 1 robots");
}

TEST_F(ValidateProposalTest, RefusesNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (double bad : {nan, infinity, -infinity}) {
    EXPECT_NE(Check({RobotId(0), {.vx = bad}}), "");
    EXPECT_NE(Check({RobotId(0), {.vy = bad}}), "");
    EXPECT_NE(Check({RobotId(0), {.wz = bad}}), "");
  }
}

TEST_F(ValidateProposalTest, RefusesTooMuchSpeedOrAcceleration) {
  EXPECT_EQ(Check({RobotId(0), {.vx = 0.2}}),
            "found the twist (0.2 m/s, 0 m/s, 0 rad/s) after (0 m/s, 0 m/s, 0 rad/s), expected one within the drive's "
            "bounds: (0.1 m/s, 0 m/s, 0 rad/s) is the nearest");
  EXPECT_NE(Check({RobotId(0), {.vy = 0.1}}), "") << "a differential drive does not move sideways";
  state_.robots[0].twist = {.vx = 1.0};
  EXPECT_NE(Check({RobotId(0), {.vx = 1.05}}), "");
  EXPECT_NE(Check({RobotId(0), {}}), "") << "it cannot brake that hard";
}

}  // namespace
}  // namespace troupe
