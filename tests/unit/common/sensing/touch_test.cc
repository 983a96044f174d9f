// Bumpers and contact sensors.
#include <gtest/gtest.h>

#include "common/sensing/sensor_suite.h"
#include "tests/support/gripper_world.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"
#include "world-service/core/step.h"

namespace troupe::test {
namespace {

// Four sides of the cube that is the robot, from the front counter-clockwise, over the heights 0.1 to 0.3.
BumperParameters FourSides() {
  BumperParameters bumper;
  for (int i = 0; i < 4; ++i) {
    bumper.segments.push_back({Pose{0.0, 0.0, 0.1, WrapAngle(0.5 * kPi * i)} * Pose{0.2, 0.0, 0.0, 0.0}, 0.4});
  }
  bumper.height = 0.2;
  return bumper;
}

class TouchTest : public testing::Test {
 protected:
  TouchTest() : robot_(world_.AddRobot("r", {})) {}

  std::vector<std::string> Press(const WorldState* state = nullptr) {
    WorldDescription world = world_.world();
    const std::size_t sensor = AddSensor(world, robot_, {}, FourSides());
    const SensedScene sensed(world, state != nullptr ? std::optional(*state) : std::nullopt);
    std::vector<std::string> names;
    for (const BumperReading::Segment& segment : sensed.MeasureAs<BumperReading>(robot_, sensor).segments) {
      names.push_back(segment.pressed_by ? world.model(*segment.pressed_by).name : "");
    }
    return names;
  }
  std::vector<BodyContact> Contacts() {
    WorldDescription world = world_.world();
    const std::size_t sensor = AddSensor(world, robot_, {}, ContactParameters{});
    return SensedScene(world).MeasureAs<ContactReading>(robot_, sensor).contacts;
  }
  using Names = std::vector<std::string>;

  SmallWorld world_;
  RobotId robot_;
};

TEST_F(TouchTest, ARobotThatStopsAtAWallPressesItsFront) {
  world_.AddBox("wall", 1.0, 0.0, 0.2, 4.0, {0.0, 1.0});
  const Scene scene(world_.world());
  WorldState state = InitialState(scene);
  const Proposal ahead{robot_, {0.93, 0.0, 0.0}};
  int ticks = 0;
  while (!state.robots[0].stalled && ticks < 100) {
    EXPECT_EQ(Press(&state), (Names{"", "", "", ""}));
    state = Step(scene, state, std::span(&ahead, 1)).state;
    ++ticks;
  }
  ASSERT_TRUE(state.robots[0].stalled);
  EXPECT_EQ(Press(&state), (Names{"wall", "", "", ""}));
  const Proposal back{robot_, {-0.1, 0.0, 0.0}};
  state = Step(scene, state, std::span(&back, 1)).state;
  EXPECT_EQ(Press(&state), (Names{"", "", "", ""}));
}

TEST_F(TouchTest, BothRobotsOfAContactFeelIt) {
  world_.AddRobot("left", {0.1, 0.4, 0.0, 0.0});
  EXPECT_EQ(Press(), (Names{"", "left", "", ""}));
}

TEST_F(TouchTest, HeightsDecide) {
  world_.AddBox("shelf", 0.3, 0.0, 0.2, 0.2, {0.3, 1.0});
  world_.AddBox("kerb", -0.3, 0.0, 0.2, 0.2, {0.0, 0.1});
  EXPECT_EQ(Press(), (Names{"", "", "", ""}));
  world_.AddBox("low shelf", 0.3, 0.0, 0.2, 0.2, {0.29, 1.0});
  EXPECT_EQ(Press(), (Names{"low shelf", "", "", ""}));
}

TEST_F(TouchTest, ABodyWithoutObstacleReturnPressesNothing) {
  world_.AddBox("mist", 0.3, 0.0, 0.2, 0.2, {0.0, 1.0}).obstacle_return = false;
  EXPECT_EQ(Press(), (Names{"", "", "", ""}));
  EXPECT_TRUE(Contacts().empty());
}

TEST_F(TouchTest, AMillimetreIsAContactAndTwoAreNot) {
  world_.AddBox("near", 0.3009, 0.0, 0.2, 0.2, {0.0, 1.0});
  world_.AddBox("far", -0.302, 0.0, 0.2, 0.2, {0.0, 1.0});
  EXPECT_EQ(Press(), (Names{"near", "", "", ""}));
}

TEST_F(TouchTest, OfSeveralBodiesTheFirstModelCounts) {
  world_.AddBox("first", 0.3, 0.1, 0.2, 0.1, {0.0, 1.0});
  world_.AddBox("second", 0.3, -0.1, 0.2, 0.1, {0.0, 1.0});
  EXPECT_EQ(Press(), (Names{"first", "", "", ""}));
}

TEST_F(TouchTest, AContactSensorNamesPartsPlacesAndHeights) {
  world_.AddPart(robot_, "arm", {0.3, 0.0, 0.0, 0.0}, 0.2, 0.1, {0.2, 0.3});
  world_.AddBox("post", 0.45, 0.0, 0.1, 0.1, {0.0, 0.25});
  world_.AddBox("wall", 0.0, 0.25, 0.1, 0.1, {0.1, 2.0});
  const std::vector<BodyContact> contacts = Contacts();
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_EQ(world_.world().model(contacts[0].part).name, "r");
  EXPECT_EQ(world_.world().model(contacts[0].other).name, "wall");
  EXPECT_NEAR(contacts[0].point.y(), 0.2, 1e-12);
  EXPECT_EQ(contacts[0].z_min, 0.1);
  EXPECT_EQ(contacts[0].z_max, 0.4);
  EXPECT_EQ(world_.world().model(contacts[1].part).name, "r.arm");
  EXPECT_EQ(world_.world().model(contacts[1].other).name, "post");
  EXPECT_NEAR(contacts[1].point.x(), 0.4, 1e-12);
  EXPECT_EQ(contacts[1].z_min, 0.2);
  EXPECT_EQ(contacts[1].z_max, 0.25);
}

TEST_F(TouchTest, LinesOfAScanLogNameTheBodies) {
  world_.AddBox("wall", 0.3, 0.0, 0.2, 0.2, {0.0, 0.25});
  WorldDescription world = world_.world();
  AddSensor(world, robot_, {}, FourSides());
  AddSensor(world, robot_, {}, ContactParameters{});
  const SensedScene sensed(world);
  EXPECT_EQ(sensed.JsonLines(robot_, 0),
            "{\"tick\":0,\"robot\":\"r\",\"sensor\":\"bumper:0\",\"pressed_by\":[\"wall\",null,null,null]}\n");
  EXPECT_EQ(sensed.JsonLines(robot_, 1),
            "{\"tick\":0,\"robot\":\"r\",\"sensor\":\"contact:1\",\"contacts\":[{\"part\":\"r\",\"other\":\"wall\","
            "\"point\":[0.19999999999999998,-0.1],\"z\":[0,0.25]}]}\n");
}

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

TEST_F(BreakBeamTest, APersonNearerDoesNotHideAnObject) {
  const ObjectId box = world_.AddObject({1.35, 1.9, 0.0, 0.0}, 0.05);
  const ModelId root = world_.AddModel(Square(0.05), {0.0, 1.75}, {1.35, 2.1, 0.0, 0.0});
  world_.world.people.push_back({.root = root, .radius = 0.05});
  EXPECT_EQ(Measure(), Broken{box});
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
