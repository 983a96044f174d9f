#include "robot-agent/sensors/break_beam.h"

#include <gtest/gtest.h>

#include "tests/support/gripper_world.h"

namespace troupe::test {
namespace {

class BreakBeamTest : public testing::Test {
 protected:
  // Between the fingers, which have 0.3 m between them from y = -0.15 to 0.15, 0.35 m in front of the robot.
  BreakBeamTest() : robot_(world_.AddGripperRobot({1.0, 2.0, 0.0, 0.0})) {
    world_.world.grippers[0].beams = {{{0.1, 0.15}, {0.1, -0.15}, 0.05}};
  }
  std::vector<std::optional<ObjectId>> Measure(double lift = 0.0, double heading = 0.0) {
    const Scene scene(world_.world);
    WorldState state = InitialState(world_.world);
    state.joints[robot_.lift.index()].position = lift;
    state.robots[0].X_WR.heading = heading;
    BodyIndex bodies(scene);
    bodies.Assign(state);
    std::vector<std::optional<ObjectId>> broken{ObjectId(17)};  // from before
    MeasureBeams(scene, bodies, robot_.gripper, broken);
    return broken;
  }
  using Broken = std::vector<std::optional<ObjectId>>;

  GripperWorld world_;
  GripperRobot robot_;
};

TEST_F(BreakBeamTest, NothingInFrontBreaksNothing) {
  world_.AddObject({1.6, 2.0, 0.0, 0.0});
  EXPECT_EQ(Measure(), Broken{std::nullopt});
}

TEST_F(BreakBeamTest, AnObjectBetweenTheFingersBreaksIt) {
  world_.AddObject({4.0, 2.0, 0.0, 0.0});
  const ObjectId box = world_.AddObject({1.35, 2.0, 0.0, 0.3});
  EXPECT_EQ(Measure(), Broken{box});
}

TEST_F(BreakBeamTest, TouchingDoesNotBreakIt) {
  world_.AddObject({1.4, 2.0, 0.0, 0.0});  // its back side is in the line of the beam
  EXPECT_EQ(Measure(), Broken{std::nullopt});
}

TEST_F(BreakBeamTest, OtherThingsDoNotBreakIt) {
  world_.AddModel(Square(0.1), {0.0, 0.1}, {1.35, 2.0, 0.0, 0.0});
  EXPECT_EQ(Measure(), Broken{std::nullopt});
}

TEST_F(BreakBeamTest, TheNearestToTheFirstEndIsTold) {
  world_.AddObject({1.35, 1.95, 0.0, 0.0}, 0.05);
  const ObjectId left = world_.AddObject({1.35, 2.05, 0.0, 0.0}, 0.05);
  EXPECT_EQ(Measure(), Broken{left});
}

TEST_F(BreakBeamTest, ItRisesWithTheLift) {
  world_.AddObject({1.35, 2.0, 0.0, 0.0});  // 0.1 m high
  const ObjectId above = world_.AddObject({1.35, 2.0, 0.4, 0.0});
  EXPECT_EQ(Measure(0.2), Broken{std::nullopt});
  EXPECT_EQ(Measure(0.4), Broken{above});
}

TEST_F(BreakBeamTest, ItTurnsWithTheRobot) {
  const ObjectId behind = world_.AddObject({0.65, 2.0, 0.0, 0.0});
  EXPECT_EQ(Measure(), Broken{std::nullopt});
  EXPECT_EQ(Measure(0.0, kPi), Broken{behind});
}

TEST_F(BreakBeamTest, EveryBeamIsMeasured) {
  const ObjectId box = world_.AddObject({1.35, 2.0, 0.0, 0.0});
  world_.world.grippers[0].beams.push_back({{0.3, 0.15}, {0.3, -0.15}, 0.05});
  EXPECT_EQ(Measure(), (Broken{box, std::nullopt}));
}

}  // namespace
}  // namespace troupe::test
