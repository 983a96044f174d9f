#include <gtest/gtest.h>

#include "common/sensing/sensor_suite.h"
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
    WorldState state = PlacedState(world_.world);
    state.joints[robot_.lift.index()].position = lift;
    state.robots[0].X_WR.heading = heading;
    BodyIndex bodies(scene);
    bodies.Assign(state);
    const SensorReading reading = MakeSensors(scene, robot_.robot).at(0)->Measure({scene, bodies}, state.tick);
    std::vector<std::optional<ObjectId>> broken;
    for (const auto& [beam, object] : reading.break_beams()->beams) broken.push_back(object);
    return broken;
  }
  using Broken = std::vector<std::optional<ObjectId>>;

  GripperWorld world_;
  GripperRobot robot_;
};

TEST_F(BreakBeamTest, WithoutAnObjectInFrontNoBeamBreaks) {
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

TEST_F(BreakBeamTest, OnlyObjectsBreakIt) {
  world_.AddModel(Square(0.1), {0.0, 0.1}, {1.35, 2.0, 0.0, 0.0});
  EXPECT_EQ(Measure(), Broken{std::nullopt});
}

TEST_F(BreakBeamTest, TheNearestToTheFirstEndBreaksIt) {
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

TEST_F(BreakBeamTest, AReadingCarriesItsGeometry) {
  const Scene scene(world_.world);
  BodyIndex bodies(scene);
  bodies.Assign(PlacedState(world_.world));
  const SensorReading reading = MakeSensors(scene, robot_.robot).at(0)->Measure({scene, bodies}, 0);
  EXPECT_EQ(reading.ranger(), nullptr);
  EXPECT_EQ(reading.break_beams()->gripper_model, world_.world.grippers[0].model);
  EXPECT_EQ(reading.break_beams()->beams[0].beam, world_.world.grippers[0].beams[0]);
}

TEST_F(BreakBeamTest, ALineOfAScanLogNamesTheObjects) {
  const ObjectId box = world_.AddObject({1.35, 2.0, 0.0, 0.0});
  world_.world.grippers[0].beams.push_back({{0.3, 0.15}, {0.3, -0.15}, 0.05});
  const Scene scene(world_.world);
  BodyIndex bodies(scene);
  bodies.Assign(PlacedState(world_.world));
  const std::unique_ptr<const Sensor> sensor = std::move(MakeSensors(scene, robot_.robot).at(0));
  const std::string name = world_.world.model(world_.world.objects[box.index()]).name;
  EXPECT_EQ(sensor->JsonLines(world_.world, sensor->Measure({scene, bodies}, 7)),
            "{\"tick\":7,\"robot\":\"" + world_.world.robots[0].name + "\",\"sensor\":\"" +
                world_.world.grippers[0].name + ".beams\",\"broken_by\":[\"" + name + "\",null]}\n");
}

TEST_F(BreakBeamTest, MeasuresAllBeams) {
  const ObjectId box = world_.AddObject({1.35, 2.0, 0.0, 0.0});
  world_.world.grippers[0].beams.push_back({{0.3, 0.15}, {0.3, -0.15}, 0.05});
  EXPECT_EQ(Measure(), (Broken{box, std::nullopt}));
}

}  // namespace
}  // namespace troupe::test
