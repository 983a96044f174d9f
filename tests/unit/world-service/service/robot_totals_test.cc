// What each robot did in a run.
#include "world-service/service/robot_totals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/small_world.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

// Two robots and a wall; the first robot has a store of energy.
class RobotTotalsTest : public testing::Test {
 protected:
  RobotTotalsTest() {
    world_.AddBox("wall", 5.0, 0.0, 1.0, 4.0, {0.0, 1.0});
    world_.AddRobot("a", {0.0, 0.0, 0.0, 0.0});
    world_.AddRobot("b", {0.0, 2.0, 0.0, 0.0});
    description_ = world_.world();
    PowerDescription& power = description_.models[description_.robots[0].root.index()].power;
    power.has_store = true;
    power.joules = 50.0;
    power.capacity = 100.0;
    scene_ = std::make_shared<const Scene>(description_);
    totals_.OnWorldChange(scene_, 0);
    frame_.state = PlacedState(description_);
    Commit();
  }

  // A step after which the robots are at these places.
  void Step(double x_of_a, double x_of_b, std::vector<Event> events = {}, std::vector<RobotCommand> commands = {}) {
    ++frame_.state.tick;
    frame_.state.robots[0].X_WR.x = x_of_a;
    frame_.state.robots[1].X_WR.x = x_of_b;
    frame_.events = std::move(events);
    commands_ = std::move(commands);
    Commit();
  }
  void Commit(const AppliedEdit* edit = nullptr) {
    EXPECT_TRUE(
        totals_.OnTick({.frame = frame_, .proposals = {}, .edit = edit, .before = nullptr, .commands = commands_})
            .ok());
  }
  std::vector<RobotTotal> Totals(std::size_t most = 10) const { return totals_.Collect(most); }

  SmallWorld world_;
  WorldDescription description_;
  std::shared_ptr<const Scene> scene_;
  FrameMessage frame_;
  std::vector<RobotCommand> commands_;
  RobotTotals totals_;
};

TEST_F(RobotTotalsTest, AddUpDistancesAndTheEnergyThatIsLeft) {
  Step(1.0, 0.0);
  Step(0.5, 0.25);
  frame_.state.stores[0].joules = 20.0;
  Step(0.5, 0.5);
  const std::vector<RobotTotal> totals = Totals();
  ASSERT_THAT(totals, SizeIs(2));
  EXPECT_EQ(totals[0].robot, "a");
  EXPECT_DOUBLE_EQ(totals[0].distance, 1.5);
  EXPECT_DOUBLE_EQ(totals[1].distance, 0.5);
  EXPECT_EQ(totals[0].joules, 20.0);
  EXPECT_EQ(totals[0].capacity, 100.0);
  EXPECT_FALSE(totals[1].joules);
  EXPECT_THAT(Totals(1), SizeIs(1));
}

TEST_F(RobotTotalsTest, CountContactsByObstacle) {
  const auto stall = [&](int robot, ModelId other) {
    return Event{.type = EventType::kStallBegan, .robot = RobotId(robot), .other = other};
  };
  const ModelId wall(0);
  const ModelId other = description_.robots[1].root;
  Step(0.0, 0.0, {stall(0, other)});
  Step(0.0, 0.0, {stall(0, wall), {.type = EventType::kGripped, .robot = RobotId(1), .object = wall}});
  Step(0.0, 0.0, {stall(0, wall), {.type = EventType::kStallEnded, .robot = RobotId(0)}});
  const std::vector<RobotTotal> totals = Totals();
  EXPECT_EQ(totals[0].stalls, 3u);
  EXPECT_THAT(totals[0].contacts, ElementsAre("wall", "b"));
  EXPECT_EQ(totals[1].stalls, 0u);
  EXPECT_EQ(totals[1].grips, 1u);
}

TEST_F(RobotTotalsTest, AGoalIsReachedOnceAtItsLastPoint) {
  const auto goal = [](std::uint32_t number, double x) {
    return std::vector<RobotCommand>{{.robot = RobotId(0), .goal = Goal{number, {{9.0, 9.0}, {x, 0.0}}}}};
  };
  Step(0.0, 0.0, {}, goal(1, 2.0));
  Step(1.0, 0.0, {}, goal(1, 2.0));
  EXPECT_EQ(Totals()[0].goals, 1u);
  EXPECT_EQ(Totals()[0].goals_reached, 0u);
  Step(1.9, 0.0, {}, goal(1, 2.0));
  Step(1.95, 0.0, {}, goal(1, 2.0));
  EXPECT_EQ(Totals()[0].goals_reached, 1u);
  Step(1.9, 0.0, {}, goal(2, 5.0));
  EXPECT_EQ(Totals()[0].goals, 2u);
  EXPECT_EQ(Totals()[0].goals_reached, 1u);
}

TEST_F(RobotTotalsTest, EditsOfUsersAreNoDistanceAndAResetStartsAnew) {
  Step(1.0, 0.0);
  const control::Request request = control::Reset();
  const AppliedEdit edit{request};
  frame_.state.robots[0].X_WR.x = 7.0;
  frame_.edition = 1;
  Commit(&edit);
  Step(7.5, 0.0);
  EXPECT_DOUBLE_EQ(Totals()[0].distance, 1.5);
  frame_.edition = frame_.fresh_edition = 2;
  frame_.state.tick = 0;
  Commit(&edit);
  EXPECT_EQ(Totals()[0].distance, 0.0);
  EXPECT_EQ(totals_.since(), 0u);
}

}  // namespace
}  // namespace troupe
