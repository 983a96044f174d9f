// Changes of a world from outside the simulation.
#include "world-service/core/edit_world.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/gripper_world.h"
#include "world-service/core/step.h"

namespace troupe::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A scene and a state, with one edit after another.
class EditWorldTest : public testing::Test {
 protected:
  void Make(const WorldDescription& world) {
    original = scene = std::make_shared<const Scene>(world);
    state = InitialState(*scene);
  }
  // The reason of a refusal; "" if there was none.
  std::string Apply(Result<EditedWorld> edited) {
    if (!edited.ok()) return edited.error().ToString();
    EXPECT_TRUE(Validate(edited.value().scene->world()).ok());
    scene = edited.value().scene;
    state = edited.value().state;
    events = edited.value().events;
    return "";
  }
  std::string Set(const std::string& name, const Pose& pose) { return Apply(SetPose(scene, state, name, pose)); }
  std::string Delete(const std::string& name) { return Apply(DeleteEntity(scene, state, name)); }
  std::string Spawn(const WorldDescription& spawned, const std::string& name, const Pose& pose) {
    return Apply(SpawnEntity(scene, state, spawned, name, pose));
  }
  void Step(const std::vector<GripperDemand>& demands, int ticks = 1) {
    GripperRun run(scene->world());
    run.state = state;
    run.Step(demands, ticks);
    state = run.state;
  }
  const std::string& NameOf(ModelId model) const { return scene->world().model(model).name; }

  GripperWorld test;
  std::shared_ptr<const Scene> original;
  std::shared_ptr<const Scene> scene;
  WorldState state;
  std::vector<Event> events;
};

TEST_F(EditWorldTest, MovesARobotWithoutAnyOtherChange) {
  const RobotId robot = test.AddRobot(Square(0.4), {0.0, 0.5}, {});
  test.AddRobot(Square(0.4), {0.0, 0.5}, {3.0, 0.0, 0.0, 0.0});
  Make(test.world);
  Step({{.twist = {1.0, 0.0, 0.0}}, {}});
  const WorldState before = state;
  EXPECT_EQ(Set("m0", {5.0, 1.0, 0.0, 7.0}), "");
  EXPECT_EQ(scene, original) << "the description is the same";
  EXPECT_EQ(state.robots[robot.index()].X_WR, (Pose{5.0, 1.0, 0.0, WrapAngle(7.0)}));
  EXPECT_EQ(state.robots[robot.index()].twist, Twist{});
  EXPECT_EQ(state.robots[1], before.robots[1]);
  EXPECT_EQ(state.tick, before.tick);
}

TEST_F(EditWorldTest, RefusesPosesThatOverlapObstacles) {
  test.AddRobot(Square(0.4), {0.0, 0.5}, {});
  test.AddModel(Square(1.0), {0.0, 0.5}, {3.0, 0.0, 0.0, 0.0});
  test.AddObject({0.0, 3.0, 0.0, 0.0});
  Make(test.world);
  EXPECT_EQ(Set("m0", {2.4, 0.0, 0.0, 0.0}), "error: 'm0' would be inside 'm1'");
  EXPECT_EQ(Set("m0", {2.3, 0.0, 0.0, 0.0}), "") << "touching is not inside";
  EXPECT_EQ(Set("m0", {3.0, 0.0, 0.5, 0.0}), "") << "above it";
  EXPECT_EQ(Set("m0", {0.1, 3.1, 0.0, 0.0}), "error: 'm0' would be inside 'm2'");
  EXPECT_EQ(Set("m2", {3.2, 0.0, 0.1, 0.0}), "error: 'm2' would be inside 'm1'");
  EXPECT_EQ(Set("m1", {0.2, 3.2, 0.0, 0.0}), "error: 'm1' would be inside 'm2'");
}

TEST_F(EditWorldTest, RefusesUnknownNamesPartsAndNumbersThatAreNotFinite) {
  const RobotId robot = test.AddRobot(Square(0.4), {0.0, 0.5}, {});
  const ModelId part = test.AddModel(Square(0.1), {0.5, 0.6}, {}, test.world.robot(robot).root);
  test.model(part).name = "m0.mast";
  Make(test.world);
  EXPECT_EQ(Set("m9", {}), "error: the world has no entity 'm9'");
  EXPECT_EQ(Set("", {}), "error: the world has no entity ''");
  EXPECT_EQ(Set("m0.mast", {}), "error: 'm0.mast' is a part of 'm0', expected a whole entity");
  EXPECT_EQ(Delete("m0.mast"), "error: 'm0.mast' is a part of 'm0', expected a whole entity");
  EXPECT_EQ(Set("m0", {kNan, 0.0, 0.0, 0.0}), "error: found a pose that is not finite");
  EXPECT_EQ(Set("m0", {0.0, 0.0, 0.0, std::numeric_limits<double>::infinity()}),
            "error: found a pose that is not finite");
  EXPECT_EQ(Set("m0", {2e6, 0.0, 0.0, 0.0}), "error: found a pose beyond 1e6, expected one in the world");
  EXPECT_EQ(state, PlacedState(test.world));
}

TEST_F(EditWorldTest, RefusesPosesBelowTheGround) {
  test.AddRobot(Square(0.4), {0.0, 0.5}, {});
  test.AddModel(Square(1.0), {0.0, 0.5}, {3.0, 0.0, 0.0, 0.0});
  test.AddObject({0.0, 3.0, 0.0, 0.0});
  test.AddModel(Square(0.2), {0.3, 0.4}, {5.0, 0.0, 0.0, 0.0});
  Make(test.world);
  EXPECT_EQ(Set("m0", {0.0, 0.0, -5.0, 0.0}), "error: 'm0' would be 5 m below the ground, expected z of at least 0");
  EXPECT_EQ(Set("m1", {3.0, 0.0, -0.1, 0.0}), "error: 'm1' would be 0.1 m below the ground, expected z of at least 0");
  EXPECT_EQ(Set("m2", {0.0, 3.0, -0.1, 0.0}), "error: 'm2' would be 0.1 m below the ground, expected z of at least 0");
  EXPECT_EQ(Set("m3", {5.0, 0.0, -0.4, 0.0}),
            "error: 'm3' would be 0.1 m below the ground, expected z of at least -0.3");
  EXPECT_EQ(Set("m3", {5.0, 0.0, -0.3, 0.0}), "") << "its block is above its origin";
  EXPECT_EQ(Set("m0", {0.0, 0.0, -1e-9, 0.0}), "") << "rounding";
  GripperWorld box;
  box.AddObject({});
  EXPECT_EQ(Spawn(box.world, "b", {1.0, 5.0, -2.0, 0.0}),
            "error: 'b' would be 2 m below the ground, expected z of at least 0");
}

TEST_F(EditWorldTest, ObjectsThatLoseTheirSupportFall) {
  test.AddModel(Square(1.0), {0.0, 0.5});
  const ObjectId lower = test.AddObject({0.0, 0.0, 0.5, 0.0});
  const ObjectId upper = test.AddObject({0.0, 0.0, 0.6, 0.0});
  Make(test.world);
  EXPECT_EQ(Set("m0", {5.0, 0.0, 0.0, 0.0}), "");
  EXPECT_NE(scene, original);
  EXPECT_EQ(scene->world().model(ModelId(0)).X_PM.x, 5.0);
  Step({}, 20);
  EXPECT_EQ(state.objects[lower.index()].X_WO.z, 0.0);
  EXPECT_EQ(state.objects[upper.index()].X_WO.z, 0.1);
  EXPECT_EQ(Delete(NameOf(test.world.objects[lower.index()])), "");
  Step({}, 20);
  EXPECT_EQ(state.objects[upper.index()].X_WO.z, 0.0);
}

TEST_F(EditWorldTest, AnObjectPlacedInTheAirFalls) {
  const ObjectId object = test.AddObject({0.0, 0.0, 0.0, 0.0});
  test.AddModel(Square(1.0), {0.0, 0.5}, {5.0, 0.0, 0.0, 0.0});
  Make(test.world);
  Step({}, 2);
  EXPECT_EQ(Set("m0", {5.0, 0.0, 2.0, 1.0}), "");
  Step({}, 20);
  EXPECT_EQ(state.objects[object.index()].X_WO, (Pose{5.0, 0.0, 0.5, 1.0}));
  EXPECT_EQ(state.objects[object.index()].mode, ObjectMode::kResting);
}

// A robot that holds a box in the air.
class HoldingTest : public EditWorldTest {
 protected:
  HoldingTest() {
    hand = test.AddGripperRobot({});
    box = test.AddObject({0.33, 0.0, 0.0, 0.0});
    Make(test.world);
    Step({{.fingers = 0.5}}, 5);
    Step({{.lift = 0.5}}, 5);
  }
  const ObjectState& object() const { return state.objects[box.index()]; }

  GripperRobot hand;
  ObjectId box;
};

TEST_F(HoldingTest, HoldsTheBoxAtFirst) {
  EXPECT_EQ(object().holder, hand.gripper);
  EXPECT_GT(object().X_WO.z, 0.1);
}

TEST_F(HoldingTest, ARobotThatIsMovedReleases) {
  EXPECT_EQ(Set(NameOf(hand.root), {-5.0, 0.0, 0.0, 0.0}), "");
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].type, EventType::kReleased);
  EXPECT_EQ(state.grippers[0], GripperState{});
  Step({{}}, 20);
  EXPECT_EQ(object().X_WO.z, 0.0);
  EXPECT_EQ(object().mode, ObjectMode::kResting);
}

TEST_F(HoldingTest, ARobotThatIsDeletedReleases) {
  EXPECT_EQ(Delete(NameOf(hand.root)), "");
  EXPECT_FALSE(RobotExists(scene->world(), hand.robot));
  Step({{}}, 20);
  EXPECT_EQ(object().X_WO.z, 0.0);
}

TEST_F(HoldingTest, AnExtractedEntityCanBeSpawnedAgain) {
  const WorldDescription robot = ExtractEntity(scene->world(), hand.root);
  const WorldDescription can = ExtractEntity(scene->world(), test.world.objects[0]);
  EXPECT_TRUE(Validate(robot).ok());
  EXPECT_EQ(robot.models[0], scene->world().model(hand.root));
  const std::size_t joints = scene->world().joints.size();
  EXPECT_EQ(Delete(NameOf(hand.root)), "");
  EXPECT_EQ(Spawn(robot, "again", {5.0, 5.0, 0.0, 0.0}), "");
  EXPECT_EQ(Spawn(can, "can", {5.33, 5.0, 0.0, 0.0}), "");
  ASSERT_EQ(scene->world().joints.size(), 2 * joints);
  const std::size_t spawned = state.objects.size() - 1;
  GripperDemand grip{.fingers = 0.5};
  Step({{}, grip}, 5);
  EXPECT_EQ(state.objects[spawned].holder, GripperId(1)) << "it grips as before";
}

TEST_F(HoldingTest, ABoxThatIsMovedIsReleased) {
  EXPECT_EQ(Set(NameOf(test.world.objects[0]), {3.0, 0.0, 0.0, 0.0}), "");
  EXPECT_EQ(state.grippers[0], GripperState{});
  Step({{.lift = 0.1}}, 3);
  EXPECT_EQ(object().X_WO, (Pose{3.0, 0.0, 0.0, 0.0}));
}

TEST_F(HoldingTest, AGripperForgetsABoxThatIsDeleted) {
  EXPECT_EQ(Delete(NameOf(test.world.objects[0])), "");
  EXPECT_EQ(state.grippers[0], GripperState{});
  EXPECT_EQ(object().holder, std::nullopt);
  Step({{.lift = 0.1, .fingers = 0.5}}, 10);
  EXPECT_EQ(state.grippers[0].clamped, std::nullopt);
}

TEST_F(EditWorldTest, ADeletedEntityIsNoObstacleAndItsNameIsFree) {
  test.AddRobot(Square(0.4), {0.0, 0.5}, {});
  test.AddRobot(Square(0.4), {0.0, 0.5}, {1.0, 0.0, 0.0, 0.0});
  Make(test.world);
  EXPECT_EQ(Delete("m1"), "");
  EXPECT_EQ(Delete("m1"), "error: the world has no entity 'm1'");
  EXPECT_EQ(FindRobot(scene->world(), "m1"), std::nullopt);
  Step({{.twist = {1.0, 0.0, 0.0}}, {}}, 20);
  EXPECT_DOUBLE_EQ(state.robots[0].X_WR.x, 2.0);
  EXPECT_EQ(Set("m1", {}), "error: the world has no entity 'm1'");
  TestWorld again;
  again.AddRobot(Square(0.2), {0.0, 0.5}, {});
  EXPECT_EQ(Spawn(again.world, "m1", {5.0, 0.0, 0.0, 0.0}), "");
  EXPECT_EQ(FindRobot(scene->world(), "m1"), RobotId(2));
}

TEST_F(EditWorldTest, AppendsASpawnedRobotWithAllItsParts) {
  test.AddGripperRobot({});
  test.AddObject({0.0, 5.0, 0.0, 0.0});
  Make(test.world);
  GripperWorld other;
  GripperRobot hand = other.AddGripperRobot({1.0, 2.0, 0.0, 0.0});
  const std::string root = other.world.model(hand.root).name;
  for (ModelDescription& model : other.world.models) {
    if (model.parent) model.name = root + "." + model.name;
  }
  EXPECT_EQ(Spawn(other.world, "second", {3.0, 0.0, 0.0, 0.0}), "");
  const WorldDescription& world = scene->world();
  ASSERT_EQ(world.robots.size(), 2u);
  EXPECT_EQ(world.robots[1].name, "second");
  EXPECT_EQ(world.models.back().name, "second.m3");
  EXPECT_EQ(world.grippers[1].robot, RobotId(1));
  EXPECT_EQ(world.joints.size(), 6u);
  EXPECT_EQ(world.objects.size(), 1u);
  EXPECT_EQ(state.robots[1].X_WR, (Pose{3.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(state.joints.size(), 6u);
  // It works as the first one does.
  EXPECT_EQ(Set(NameOf(world.objects[0]), {3.33, 0.0, 0.0, 0.0}), "");
  Step({{}, {.fingers = 0.5}}, 5);
  EXPECT_EQ(state.objects[0].holder, GripperId(1));
}

TEST_F(EditWorldTest, SpawnsObjectsThatFall) {
  test.AddModel(Square(1.0), {0.0, 0.5});
  Make(test.world);
  GripperWorld other;
  other.AddObject({});
  EXPECT_EQ(Spawn(other.world, "box", {0.0, 0.0, 1.0, 0.0}), "");
  EXPECT_EQ(Spawn(other.world, "box2", {0.0, 0.0, 1.5, 0.0}), "");
  Step({}, 20);
  EXPECT_EQ(state.objects[0].X_WO.z, 0.5);
  EXPECT_EQ(state.objects[1].X_WO.z, 0.6);
}

TEST_F(EditWorldTest, RefusesASpawnWithoutRoomOrName) {
  test.AddRobot(Square(0.4), {0.0, 0.5}, {});
  Make(test.world);
  TestWorld one;
  one.AddModel(Square(0.4));
  EXPECT_EQ(Spawn(one.world, "new", {0.1, 0.0, 0.0, 0.0}), "error: 'new' would be inside 'm0'");
  EXPECT_EQ(Spawn(one.world, "m0", {2.0, 0.0, 0.0, 0.0}), "error: the name 'm0' is in use");
  EXPECT_EQ(Spawn(one.world, "", {2.0, 0.0, 0.0, 0.0}), "error: found no name, expected one");
  EXPECT_EQ(Spawn(one.world, "new", {kNan, 0.0, 0.0, 0.0}), "error: found a pose that is not finite");
  one.AddModel(Square(0.4));
  EXPECT_EQ(Spawn(one.world, "new", {2.0, 0.0, 0.0, 0.0}),
            "error: found 2 models to spawn, expected one, with its parts");
  EXPECT_EQ(scene, original);
}

TEST_F(EditWorldTest, ResetsToTheWorldAsLoaded) {
  test.AddRobot(Square(0.4), {0.0, 0.5}, {});
  test.AddModel(Square(1.0), {0.0, 0.5}, {3.0, 0.0, 0.0, 0.0});
  Make(test.world);
  TestWorld other;
  other.AddModel(Square(0.4));
  EXPECT_EQ(Spawn(other.world, "new", {0.0, 5.0, 0.0, 0.0}), "");
  EXPECT_EQ(Set("m1", {4.0, 0.0, 0.0, 0.0}), "");
  Step({{.twist = {1.0, 0.0, 0.0}}}, 3);
  EXPECT_EQ(Delete("m0"), "");
  const EditedWorld reset = ResetWorld(original, scene, state, {});
  EXPECT_EQ(reset.scene, original);
  EXPECT_EQ(reset.state, InitialState(*original));
  EXPECT_TRUE(reset.fresh);
}

TEST_F(EditWorldTest, ResetsOnlyTheGivenScopes) {
  test.AddRobot(Square(0.4), {0.0, 0.5}, {});
  test.AddObject({3.0, 0.0, 0.0, 0.0});
  Make(test.world);
  GripperWorld other;
  other.AddObject({});
  EXPECT_EQ(Spawn(other.world, "new", {0.0, 5.0, 0.0, 0.0}), "");
  Step({{.twist = {1.0, 0.0, 0.0}}}, 3);
  const ResetScopes none{.time = false, .state = false, .spawned = false, .deleted = false};

  ResetScopes scopes = none;
  scopes.time = true;
  EditedWorld reset = ResetWorld(original, scene, state, scopes);
  EXPECT_EQ(reset.scene, scene);
  EXPECT_EQ(reset.state.tick, 0u);
  EXPECT_EQ(reset.state.robots, state.robots);

  scopes = none;
  scopes.state = true;
  reset = ResetWorld(original, scene, state, scopes);
  EXPECT_EQ(reset.state.tick, 3u);
  EXPECT_EQ(reset.state.robots, PlacedState(test.world).robots);
  EXPECT_EQ(reset.state.objects[0].mode, ObjectMode::kResting) << "it would be found at tick 0 only";
  EXPECT_EQ(reset.state.objects.size(), 2u);
  EXPECT_TRUE(reset.fresh);

  scopes = none;
  scopes.spawned = true;
  reset = ResetWorld(original, scene, state, scopes);
  EXPECT_FALSE(reset.fresh);
  EXPECT_EQ(reset.state.robots, state.robots);
  EXPECT_FALSE(FindEntity(reset.scene->world(), "new").ok());
}

}  // namespace
}  // namespace troupe::test
