// Gripping, carrying, handing over and releasing.
#include <gtest/gtest.h>

#include "tests/support/gripper_world.h"

namespace troupe {
namespace {

using test::Box;
using test::GripperRobot;
using test::GripperRun;
using test::GripperWorld;

// Between the fingers of a robot at the origin.
constexpr Pose kReach{0.33, 0.0, 0.0, 0.0};

TEST(Grip, HoldsAnObjectThatBothPadsTouchAtItsPose) {
  GripperWorld world;
  const GripperRobot robot = world.AddGripperRobot({});
  const ObjectId box = world.AddObject({0.33, 0.02, 0.0, 0.1});
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 40);
  EXPECT_EQ(run.object(box).mode, ObjectMode::kHeld);
  EXPECT_EQ(run.object(box).holder, robot.gripper);
  EXPECT_EQ(run.object(box).X_WO, (Pose{0.33, 0.02, 0.0, 0.1})) << "nothing teleports";
  EXPECT_LT(run.position(robot.left), run.position(robot.right)) << "the box is nearer to the left";
  EXPECT_EQ(run.state.grippers[0].left_contact, world.world.objects[0]);
  const std::vector<Event> gripped = run.EventsOf(EventType::kGripped);
  ASSERT_EQ(gripped.size(), 1u);
  EXPECT_EQ(gripped[0].robot, robot.robot);
  EXPECT_EQ(gripped[0].object, world.world.objects[0]);
  EXPECT_TRUE(run.EventsOf(EventType::kBlocked).empty()) << "the contact of a pad with an object is no blocked finger";
}

TEST(Grip, CarriesTheHeldObjectAndTheStackOnIt) {
  GripperWorld world;
  const GripperRobot robot = world.AddGripperRobot({});
  const ObjectId lower = world.AddObject(kReach);
  const ObjectId upper = world.AddObject({0.35, 0.01, 0.1, 0.3}, 0.08, 0.05);
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 30);
  const Pose X_GO = Inverse(run.X_WM(robot.carriage)) * run.object(lower).X_WO;
  const Pose X_GU = Inverse(run.X_WM(robot.carriage)) * run.object(upper).X_WO;
  run.Step({{.lift = 0.2}}, 10);
  EXPECT_NEAR(run.object(lower).X_WO.z, 0.2, 1e-12);
  EXPECT_NEAR(run.object(upper).X_WO.z, 0.3, 1e-12);
  run.Step({{.twist = {0.5, 0.1, 0.7}}}, 25);
  for (const auto& [object, before] : {std::pair{lower, X_GO}, std::pair{upper, X_GU}}) {
    const Pose now = Inverse(run.X_WM(robot.carriage)) * run.object(object).X_WO;
    EXPECT_NEAR(now.x, before.x, 1e-9);
    EXPECT_NEAR(now.y, before.y, 1e-9);
    EXPECT_NEAR(now.z, before.z, 1e-9);
    EXPECT_NEAR(now.heading, before.heading, 1e-9);
  }
  EXPECT_EQ(run.object(upper).support, world.world.objects[0]);
}

TEST(Grip, ACarriedBoxHitsTheWallFirst) {
  GripperWorld world;
  world.AddModel(Box(1.0, -1.0, 1.1, 1.0), {0.0, 2.0});
  world.AddGripperRobot({});
  const ObjectId box = world.AddObject({0.40, 0.0, 0.0, 0.0});  // sticks out of the fingers
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 30);
  ASSERT_EQ(run.object(box).mode, ObjectMode::kHeld);
  run.Step({{.twist = {1.0, 0.0, 0.0}}}, 20);
  EXPECT_TRUE(run.state.robots[0].stalled);
  EXPECT_NEAR(run.object(box).X_WO.x + 0.05, 1.0, 1e-8);
}

TEST(Grip, WithoutAPayloadTheFingersHitTheWall) {
  GripperWorld world;
  world.AddModel(Box(1.0, -1.0, 1.1, 1.0), {0.0, 2.0});
  world.AddGripperRobot({});
  GripperRun run(world.world);
  run.Step({{.twist = {1.0, 0.0, 0.0}}}, 20);
  EXPECT_NEAR(run.state.robots[0].X_WR.x + 0.41, 1.0, 1e-8);
}

TEST(Grip, ALiftedGripperDrivesOverALowObstacle) {
  GripperWorld world;
  world.AddModel(Box(0.5, -1.0, 0.6, 1.0), {0.0, 0.4});
  world.AddGripperRobot({});
  GripperRun run(world.world);
  run.Step({{.lift = 0.5}}, 9);
  run.Step({{.twist = {1.0, 0.0, 0.0}}}, 20);
  EXPECT_NEAR(run.state.robots[0].X_WR.x + 0.2, 0.5, 1e-8) << "only the body is stopped";
}

TEST(Grip, LowersABoxExactlyOntoAnother) {
  GripperWorld world;
  world.AddGripperRobot({});
  const ObjectId box = world.AddObject(kReach, 0.1, 0.1);
  const ObjectId base = world.AddObject({1.33, 0.0, 0.0, 0.0}, 0.12, 0.13);
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 30);
  run.Step({{.lift = 0.5}}, 10);
  run.Step({{.twist = {1.0, 0.0, 0.0}}}, 10);
  run.Step({{.lift = -0.5}}, 20);
  EXPECT_NEAR(run.object(box).X_WO.z, 0.13, 1e-8);
  run.Step({{.fingers = -0.05}}, 30);
  EXPECT_EQ(run.object(box).X_WO.z, 0.13);
  EXPECT_EQ(run.object(box).mode, ObjectMode::kResting);
  EXPECT_EQ(run.object(box).support, world.world.objects[base.index()]);
  ASSERT_EQ(run.EventsOf(EventType::kReleased).size(), 1u);
  ASSERT_EQ(run.EventsOf(EventType::kLanded).size(), 1u);
  EXPECT_EQ(run.EventsOf(EventType::kLanded)[0].other, world.world.objects[base.index()]);
}

TEST(Grip, LoweringStopsWhenThePayloadTouchesASupport) {
  GripperWorld world;
  world.AddModel(Box(0.9, -1.0, 2.0, 1.0), {0.0, 0.3});
  const GripperRobot robot = world.AddGripperRobot({0.0, 0.0, 0.0, 0.0});
  const ObjectId box = world.AddObject({0.40, 0.0, 0.0, 0.0}, 0.1, 0.1);
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 30);
  run.Step({{.lift = 0.5}}, 10);
  run.Step({{.twist = {1.0, 0.0, 0.0}}}, 6);  // now the box, and the fingers, are over the step
  run.Step({{.lift = -0.5}}, 10);
  EXPECT_NEAR(run.position(robot.lift), 0.3, 1e-8);
  EXPECT_NEAR(run.object(box).X_WO.z, 0.3, 1e-8);
  EXPECT_EQ(run.EventsOf(EventType::kBlocked).size(), 1u);
}

TEST(Grip, RaisingStopsUnderACeilingAtTheTopOfTheStack) {
  GripperWorld world;
  world.AddModel(Box(0.0, -1.0, 2.0, 1.0), {0.7, 0.8});
  const GripperRobot robot = world.AddGripperRobot({-0.5, 0.0, 0.0, 0.0});
  world.AddObject({-0.17, 0.0, 0.0, 0.0});
  const ObjectId top = world.AddObject({-0.17, 0.0, 0.1, 0.0}, 0.08, 0.2);
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 30);
  run.Step({{.lift = 0.1}}, 10);
  run.Step({{.twist = {0.5, 0.0, 0.0}}}, 10);
  run.Step({{.lift = 0.5}}, 20);
  EXPECT_NEAR(run.position(robot.lift), 0.4, 1e-8);
  EXPECT_NEAR(run.object(top).X_WO.z + 0.2, 0.7, 1e-8);
}

TEST(Grip, AnythingElseBetweenThePadsBlocksThem) {
  GripperWorld world;
  const ModelId post = world.AddModel(test::Square(0.1), {0.0, 1.0}, kReach);
  world.AddGripperRobot({});
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 40);
  EXPECT_FALSE(run.state.grippers[0].clamped);
  ASSERT_EQ(run.EventsOf(EventType::kBlocked).size(), 2u) << "one for each finger";
  EXPECT_EQ(run.EventsOf(EventType::kBlocked)[0].other, post);
}

TEST(Grip, AnObjectTouchedByOneFingerOnlyIsNotHeld) {
  GripperWorld world;
  const GripperRobot robot = world.AddGripperRobot({});
  world.world.joints[robot.right.index()].position.max = 0.05;  // stops before it reaches the box
  const ObjectId box = world.AddObject({0.33, 0.08, 0.0, 0.0});
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 60);
  EXPECT_TRUE(run.state.grippers[0].left_contact);
  EXPECT_FALSE(run.state.grippers[0].right_contact);
  EXPECT_FALSE(run.state.grippers[0].clamped);
  EXPECT_EQ(run.object(box).mode, ObjectMode::kResting);
  EXPECT_EQ(run.position(robot.right), 0.05) << "the joint stops at its limit exactly";
}

TEST(Grip, AnObjectTooWideStopsTheRobotInFrontOfIt) {
  GripperWorld world;
  world.AddGripperRobot({});
  world.AddObject({1.0, 0.0, 0.0, 0.0}, 0.4, 0.1);
  GripperRun run(world.world);
  run.Step({{.twist = {1.0, 0.0, 0.0}}}, 10);
  EXPECT_TRUE(run.state.robots[0].stalled);
  run.Step({{.fingers = 0.05}}, 40);
  EXPECT_FALSE(run.state.grippers[0].clamped);
}

TEST(Grip, AnObjectReleasedInTheAirFallsToTheGround) {
  GripperWorld world;
  world.AddGripperRobot({});
  const ObjectId box = world.AddObject(kReach);
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 30);
  run.Step({{.lift = 0.8}}, 10);
  run.Step({{.fingers = -0.05}}, 1);
  EXPECT_EQ(run.object(box).mode, ObjectMode::kFalling);
  EXPECT_NEAR(run.object(box).X_WO.z, 0.8 - 0.5 * 9.81 * 0.01, 1e-12);
  run.Step({{}}, 3);
  EXPECT_EQ(run.object(box).mode, ObjectMode::kFalling) << "0.4 s is the time that it takes";
  run.Step({{}}, 1);
  EXPECT_EQ(run.object(box).X_WO.z, 0.0);
  EXPECT_EQ(run.object(box).mode, ObjectMode::kResting);
  ASSERT_EQ(run.EventsOf(EventType::kLanded).size(), 1u);
  EXPECT_EQ(run.EventsOf(EventType::kLanded)[0].other, std::nullopt);
}

TEST(Grip, WithoutGravityAReleasedObjectStaysInTheAir) {
  GripperWorld world;
  world.world.gravity = 0.0;
  world.AddGripperRobot({});
  const ObjectId box = world.AddObject(kReach);
  GripperRun run(world.world);
  run.Step({{.fingers = 0.05}}, 30);
  run.Step({{.lift = 0.8}}, 10);
  const double height = run.object(box).X_WO.z;
  run.Step({{.fingers = -0.05}}, 10);
  EXPECT_EQ(run.object(box).X_WO.z, height);
  EXPECT_EQ(run.object(box).mode, ObjectMode::kPlaced);
}

// Two robots that face each other across a box.
struct TwoRobots {
  TwoRobots() {
    first = world.AddGripperRobot({-0.42, 0.0, 0.0, 0.0});
    second = world.AddGripperRobot({0.42, 0.0, 0.0, kPi});
    // Long enough for both: the fingers reach to 0.01 m beside the middle.
    const ModelId id = world.AddModel(Box(-0.12, -0.05, 0.12, 0.05), {0.0, 0.1});
    world.model(id).gripper_return = true;
    world.world.objects.push_back(id);
  }
  GripperWorld world;
  GripperRobot first;
  GripperRobot second;
  ObjectId box{0};
};

TEST(Grip, HandsOver) {
  TwoRobots test;
  GripperRun run(test.world.world);
  run.Step({{.fingers = 0.05}, {}}, 30);
  ASSERT_EQ(run.object(test.box).holder, test.first.gripper);
  run.Step({{}, {.fingers = 0.05}}, 30);
  EXPECT_EQ(run.object(test.box).holder, test.first.gripper);
  EXPECT_EQ(run.state.grippers[1].clamped, test.box);
  EXPECT_EQ(run.EventsOf(EventType::kBlocked).size(), 1u) << "the event names the holder to the second robot";
  run.Step({{.fingers = -0.05}, {}}, 1);
  EXPECT_EQ(run.object(test.box).holder, test.second.gripper);
  EXPECT_EQ(run.object(test.box).X_WO, Pose{});
  EXPECT_EQ(run.EventsOf(EventType::kGripped).size(), 2u);
  EXPECT_TRUE(run.EventsOf(EventType::kLanded).empty());
  run.Step({{.fingers = -0.05}, {}}, 10);
  run.Step({{}, {.twist = {-0.5, 0.0, 0.0}}}, 10);
  EXPECT_NEAR(run.object(test.box).X_WO.x, 0.5, 1e-9);
}

TEST(Grip, OfTwoAtOnceTheRobotThatActsFirstHoldsTheObject) {
  TwoRobots test;
  GripperRun run(test.world.world);
  run.Step({{.fingers = 0.05}, {.fingers = 0.05}}, 30);
  ASSERT_TRUE(run.object(test.box).holder);
  EXPECT_EQ(run.state.grippers[0].clamped, test.box);
  EXPECT_EQ(run.state.grippers[1].clamped, test.box);
  ASSERT_EQ(run.EventsOf(EventType::kGripped).size(), 1u);
  const Tick tick = run.EventsOf(EventType::kGripped)[0].tick;
  EXPECT_EQ(run.object(test.box).holder->index(), tick % 2) << "robots act in an order that depends on the tick";
}

TEST(Grip, NeitherOfTwoGrippersOnAnObjectCanPullItAway) {
  TwoRobots test;
  GripperRun run(test.world.world);
  run.Step({{.fingers = 0.05}, {.fingers = 0.05}}, 30);
  run.Step({{.twist = {0.5, 0.0, 0.2}}, {}}, 5);
  EXPECT_TRUE(run.state.robots[0].stalled);
}

TEST(Grip, AWaitingGripperForgetsAnObjectThatMovesAway) {
  TwoRobots test;
  GripperRun run(test.world.world);
  run.Step({{.fingers = 0.05}, {}}, 30);
  run.Step({{}, {.fingers = 0.05}}, 30);
  run.Step({{.lift = 0.5}, {}}, 5);
  EXPECT_NEAR(run.object(test.box).X_WO.z, 0.25, 1e-9);
  EXPECT_FALSE(run.state.grippers[1].clamped);
  run.Step({{.fingers = -0.05}, {}}, 1);
  EXPECT_EQ(run.object(test.box).mode, ObjectMode::kFalling);
}

}  // namespace
}  // namespace troupe
