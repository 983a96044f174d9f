// Objects that fall, rest, and follow their supports.
#include <gtest/gtest.h>

#include "tests/support/gripper_world.h"

namespace troupe {
namespace {

using test::Box;
using test::GripperRobot;
using test::GripperRun;
using test::GripperWorld;
using test::Square;

TEST(Gravity, AnObjectThatAFilePlacesInTheAirStaysThere) {
  GripperWorld world;
  const ObjectId box = world.AddObject({0.0, 0.0, 1.0, 0.0});
  GripperRun run(world.world);
  run.Step({}, 20);
  EXPECT_EQ(run.object(box).X_WO.z, 1.0);
  EXPECT_EQ(run.object(box).mode, ObjectMode::kPlaced);
}

TEST(Gravity, AnObjectInTheAirFallsAfterAContact) {
  GripperWorld world;
  world.AddRobot(Square(0.4), {0.0, 0.5}, {});
  const ObjectId box = world.AddObject({0.5, 0.0, 0.3, 0.0});
  GripperRun run(world.world);
  run.Step({{.twist = {1.0, 0.0, 0.0}}}, 20);
  EXPECT_EQ(run.object(box).X_WO.z, 0.0);
  EXPECT_EQ(run.EventsOf(EventType::kLanded).size(), 1u);
}

TEST(Gravity, FindsTheSupportOfEachObject) {
  GripperWorld world;
  const ModelId table = world.AddModel(Square(1.0), {0.6, 0.7});
  const ObjectId on_table = world.AddObject({0.0, 0.0, 0.7, 0.0});
  const ObjectId on_box = world.AddObject({0.04, 0.0, 0.1 + 0.7, 0.0});
  const ObjectId on_ground = world.AddObject({5.0, 0.0, 0.0, 0.0});
  GripperRun run(world.world);
  const WorldState before = run.state;
  run.Step({}, 1);
  EXPECT_EQ(run.object(on_table).support, table);
  EXPECT_EQ(run.object(on_box).support, world.world.objects[on_table.index()]);
  EXPECT_EQ(run.object(on_ground).support, std::nullopt);
  EXPECT_EQ(run.object(on_ground).mode, ObjectMode::kResting);
  EXPECT_TRUE(run.events.empty());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(run.state.objects[i].X_WO, before.objects[i].X_WO);
  const WorldState first = run.state;
  run.Step({}, 50);
  run.state.tick = first.tick;
  EXPECT_EQ(run.state, first) << "an idle world stays as it is";
}

TEST(Gravity, ARobotCarriesTheStackOnIt) {
  GripperWorld world;
  world.AddRobot(Square(0.4), {0.0, 0.5}, {});
  world.AddModel(Box(2.0, -1.0, 2.1, 1.0), {0.5, 1.0});  // a bar that only the payload hits
  const ObjectId lower = world.AddObject({0.15, 0.0, 0.5, 0.0});
  const ObjectId upper = world.AddObject({0.15, 0.0, 0.6, 0.0});
  GripperRun run(world.world);
  run.Step({{.twist = {1.0, 0.0, 0.5}}}, 10);
  EXPECT_NEAR((Inverse(run.state.robots[0].X_WR) * run.object(lower).X_WO).x, 0.15, 1e-12);
  EXPECT_NEAR((Inverse(run.state.robots[0].X_WR) * run.object(upper).X_WO).x, 0.15, 1e-12);
  EXPECT_EQ(run.object(upper).X_WO.z, 0.6);
  run.Step({{.twist = {0.0, 0.0, -0.5}}}, 10);
  run.Step({{.twist = {1.0, 0.0, 0.0}}}, 20);
  EXPECT_TRUE(run.state.robots[0].stalled);
  EXPECT_LT(run.object(lower).X_WO.x, 2.0);
}

TEST(Gravity, ABridgeFallsWhenItsLastSupportIsRemoved) {
  GripperWorld world;
  world.AddRobot(Box(-0.1, -0.1, 0.1, 0.1), {0.0, 0.5}, {-0.3, 0.0, 0.0, 0.0});
  world.AddRobot(Box(-0.1, -0.1, 0.1, 0.1), {0.0, 0.5}, {0.3, 0.0, 0.0, 0.0});
  const ObjectId beam = world.AddObject({0.0, 0.0, 0.5, 0.0});
  world.world.shapes.back().blocks = {{Box(-0.3, -0.05, 0.3, 0.05), {0.0, 0.1}}};
  GripperRun run(world.world);
  run.Step({{}, {}}, 1);
  EXPECT_EQ(run.object(beam).mode, ObjectMode::kResting);
  EXPECT_EQ(run.object(beam).support, std::nullopt);
  run.Step({{.twist = {0.0, 1.0, 0.0}}, {}}, 10);
  EXPECT_EQ(run.object(beam).X_WO.z, 0.5) << "one support is left";
  run.Step({{}, {.twist = {0.0, 1.0, 0.0}}}, 10);
  EXPECT_EQ(run.object(beam).X_WO.z, 0.0);
}

// The heights of blocks say what is above what, those of origins nothing.
TEST(Gravity, AStackFallsWhateverTheOriginsOfItsObjects) {
  for (const double origin : {-0.9, 0.0, 0.9}) {  // of the upper box, below its blocks by this height
    SCOPED_TRACE(origin);
    GripperWorld world;
    world.AddRobot(Box(-0.1, -0.1, 0.1, 0.1), {0.0, 0.5}, {-0.3, 0.0, 0.0, 0.0});
    world.AddRobot(Box(-0.1, -0.1, 0.1, 0.1), {0.0, 0.5}, {0.3, 0.0, 0.0, 0.0});
    const ObjectId upper = world.AddObject({0.0, 0.0, 1.1 - origin, 0.0});
    world.world.shapes.back().blocks = {{Square(0.1), {origin, origin + 0.1}}};
    const ObjectId lower = world.AddObject({0.0, 0.0, 1.1, 0.0});
    world.world.shapes.back().blocks = {{Box(-0.3, -0.05, 0.3, 0.05), {-0.6, 0.0}}};
    GripperRun run(world.world);
    run.Step({{}, {}}, 1);
    ASSERT_EQ(run.object(upper).support, world.world.objects[lower.index()]);
    run.Step({{.twist = {0.0, 1.0, 0.0}}, {.twist = {0.0, 1.0, 0.0}}}, 20);
    EXPECT_NEAR(run.object(lower).X_WO.z, 0.6, 1e-12);
    EXPECT_NEAR(run.object(upper).X_WO.z, 0.6 - origin, 1e-12);
    EXPECT_EQ(run.object(upper).mode, ObjectMode::kResting);
    EXPECT_EQ(run.object(upper).support, world.world.objects[lower.index()]);
  }
}

TEST(Gravity, ABridgeWithItsOriginOnTheGroundFalls) {
  GripperWorld world;
  world.AddRobot(Box(-0.1, -0.1, 0.1, 0.1), {0.0, 0.5}, {-0.3, 0.0, 0.0, 0.0});
  world.AddRobot(Box(-0.1, -0.1, 0.1, 0.1), {0.0, 0.5}, {0.3, 0.0, 0.0, 0.0});
  const ObjectId beam = world.AddObject({});
  world.world.shapes.back().blocks = {{Box(-0.3, -0.05, 0.3, 0.05), {0.5, 0.6}}};
  GripperRun run(world.world);
  run.Step({{}, {}}, 1);
  EXPECT_EQ(run.object(beam).mode, ObjectMode::kResting);
  EXPECT_EQ(run.object(beam).support, std::nullopt);
  run.Step({{.twist = {0.0, 1.0, 0.0}}, {.twist = {0.0, 1.0, 0.0}}}, 20);
  EXPECT_EQ(run.object(beam).X_WO.z, -0.5);
  EXPECT_EQ(run.object(beam).mode, ObjectMode::kResting);
}

TEST(Gravity, ReportsUnstableObjects) {
  GripperWorld world;
  const GripperRobot robot = world.AddGripperRobot({});
  const ObjectId box = world.AddObject({0.33, 0.0, 0.0, 0.0});
  const ModelId edge = world.AddModel(Box(0.36, -1.0, 2.0, 1.0), {0.2, 0.3});
  GripperRun run(world.world);
  ASSERT_EQ(run.scene.world().robot(robot.robot).root, robot.root);
  run.Step({{.fingers = 0.05}}, 30);
  run.Step({{.twist = {-0.5, 0.0, 0.0}}}, 10);
  run.Step({{.lift = 0.5}}, 8);
  run.Step({{.twist = {0.5, 0.0, 0.0}}}, 10);
  run.Step({{.fingers = -0.05}}, 10);
  EXPECT_EQ(run.object(box).X_WO.z, 0.3);
  ASSERT_EQ(run.EventsOf(EventType::kUnstable).size(), 1u);
  EXPECT_EQ(run.EventsOf(EventType::kUnstable)[0].other, edge);
}

// A robot with a tray on a lift.
struct TrayWorld {
  TrayWorld() {
    const RobotId robot = world.AddRobot(Square(0.4), {0.0, 0.1}, {});
    const ModelId tray = world.AddModel(Square(0.4), {0.1, 0.15}, {}, world.world.robot(robot).root);
    lift = world.AddJoint(robot, tray, {0.0, 0.0}, 1.0, {0.0, 1.0});
  }
  void Lift(GripperRun& run, double velocity, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      StepResult result = Step(run.scene, run.state, std::vector<Proposal>{{RobotId(0), {}, {velocity}}});
      run.state = result.state;
      run.events.insert(run.events.end(), result.events.begin(), result.events.end());
    }
  }
  GripperWorld world;
  JointId lift;
};

TEST(Gravity, AnObjectOnALiftRisesAndSinksWithIt) {
  TrayWorld test;
  const ObjectId lower = test.world.AddObject({0.0, 0.0, 0.15, 0.0});
  const ObjectId upper = test.world.AddObject({0.0, 0.0, 0.25, 0.0});
  GripperRun run(test.world.world);
  test.Lift(run, 0.5, 20);
  EXPECT_NEAR(run.object(lower).X_WO.z, 1.15, 1e-9);
  test.Lift(run, -3.0, 2);  // faster than an object falls
  EXPECT_NEAR(run.object(lower).X_WO.z, 0.55, 1e-9);
  EXPECT_NEAR(run.object(upper).X_WO.z, 0.65, 1e-9);
  EXPECT_EQ(run.object(lower).mode, ObjectMode::kResting);
  EXPECT_TRUE(run.events.empty());
}

TEST(Gravity, ALoweredLiftLeavesItsPayloadOnAShelf) {
  TrayWorld test;
  const ModelId shelf = test.world.AddModel(Box(0.25, -1.0, 1.0, 1.0), {0.5, 0.55});
  const ObjectId board = test.world.AddObject({0.2, 0.0, 0.95, 0.0}, 0.6, 0.02);
  test.world.world.joints[0].start = 0.8;
  GripperRun run(test.world.world);
  test.Lift(run, -0.5, 20);
  EXPECT_NEAR(run.object(board).X_WO.z, 0.55, 1e-12);
  EXPECT_EQ(run.position(test.lift), 0.0);
  EXPECT_EQ(run.object(board).support, std::nullopt) << "its centre is over the sunken tray";
  EXPECT_EQ(run.object(board).mode, ObjectMode::kResting);
  EXPECT_NE(shelf, test.world.world.objects[0]);
}

TEST(Gravity, GivesTheSameStackForHalfAndDoubleTicks) {
  std::vector<double> heights;
  for (std::int64_t interval_ns : {50'000'000, 100'000'000, 200'000'000}) {
    GripperWorld world;
    world.world.interval_ns = interval_ns;
    world.AddGripperRobot({});
    const ObjectId box = world.AddObject({0.33, 0.0, 0.0, 0.0});
    world.AddObject({1.33, 0.0, 0.0, 0.0}, 0.12, 0.13);
    GripperRun run(world.world);
    const auto ticks = [&](double seconds) { return static_cast<int>(seconds * 1e9 / interval_ns + 0.5); };
    run.Step({{.fingers = 0.05}}, ticks(3.0));
    run.Step({{.lift = 0.5}}, ticks(1.6));
    run.Step({{.twist = {1.0, 0.0, 0.0}}}, ticks(1.0));
    run.Step({{.fingers = -0.05}}, ticks(1.0));  // from above
    EXPECT_EQ(run.object(box).X_WO.z, 0.13);
    EXPECT_NEAR(run.object(box).X_WO.x, 1.33, 1e-3);
  }
}

// Collision at every height: each part of a robot against obstacles in every relation of their height interval to the
// part's. The part decides; the rest of the robot is beside the obstacle or over it.

// The relation of an obstacle's interval to the interval [a, b) of the part.
struct HeightCase {
  const char* name;
  // From the part's interval, the obstacle's.
  ZRange (*obstacle)(const ZRange& part);
  bool meets;
};

constexpr double kBeyondRounding = 1e-6;  // m: overlaps far beyond rounding

const HeightCase kCases[] = {
    {"below",
     [](const ZRange& p) {
       return ZRange{p.min - 0.02, p.min - 0.01};
     },
     false},
    {"above",
     [](const ZRange& p) {
       return ZRange{p.max + 0.01, p.max + 0.02};
     },
     false},
    {"touching_from_below",
     [](const ZRange& p) {
       return ZRange{p.min - 0.02, p.min};
     },
     false},
    {"touching_from_above",
     [](const ZRange& p) {
       return ZRange{p.max, p.max + 0.02};
     },
     false},
    {"overlapping_from_below",
     [](const ZRange& p) {
       return ZRange{p.min - 0.02, p.min + 0.01};
     },
     true},
    {"overlapping_from_above",
     [](const ZRange& p) {
       return ZRange{p.max - 0.01, p.max + 0.02};
     },
     true},
    {"just_overlapping_from_below",
     [](const ZRange& p) {
       return ZRange{p.min - 0.02, p.min + kBeyondRounding};
     },
     true},
    {"just_overlapping_from_above",
     [](const ZRange& p) {
       return ZRange{p.max - kBeyondRounding, p.max + 0.02};
     },
     true},
    {"containing",
     [](const ZRange& p) {
       return ZRange{p.min - 0.01, p.max + 0.01};
     },
     true},
    {"contained",
     [](const ZRange& p) {
       return ZRange{p.min + 0.01, p.max - 0.01};
     },
     true},
    {"sharing_the_bottom",
     [](const ZRange& p) {
       return ZRange{p.min, p.max - 0.01};
     },
     true},
    {"sharing_the_top",
     [](const ZRange& p) {
       return ZRange{p.min + 0.01, p.max};
     },
     true},
    {"equal", [](const ZRange& p) { return p; }, true},
};

// A part of the robot: its interval at the time when the robot drives on, and how far its front is ahead of the origin.
struct PartCase {
  const char* name;
  ZRange z;
  double front;  // m
};

const PartCase kParts[] = {
    {"body", {0.05, 0.3}, 0.2},  // a body that does not reach down to the ground
    {"laser_on_top", {0.3, 0.4}, 0.1},
    {"mast", {0.4, 1.4}, 0.03},
    {"raised_gripper", {1.5, 1.6}, 0.41},
    {"carried_box", {1.6, 1.7}, 0.44},  // sticks out of the fingers, and over them
    {"pole_on_the_carried_box", {1.7, 1.75}, 0.35},
    {"box_on_the_pole", {1.75, 1.85}, 0.42},
};

// A robot with all these parts at heights of their own, holding a box above its fingers with another one on top.
class HeightWorld {
 public:
  HeightWorld() {
    robot = world.AddGripperRobot({});
    world.world.shapes[world.world.model(robot.root).shape.index()].blocks[0].z = kParts[0].z;
    world.AddModel(test::Square(0.2), {0.0, 0.1}, {0.0, 0.0, 0.3, 0.0}, robot.root);
    world.AddModel(test::Square(0.06), {0.0, 1.0}, {0.0, 0.0, 0.4, 0.0}, robot.root);
    world.world.joints[robot.lift.index()].position.max = 2.0;
    // Held by a foot between the pads; wide only above them.
    const ModelId box = world.AddModel(
        {Block{test::Square(0.1), {0.0, 0.1}}, Block{Box(-0.1, -0.1, 0.1, 0.1), {0.1, 0.2}}}, {0.34, 0.0, 0.0, 0.0});
    world.model(box).gripper_return = true;
    world.world.objects.push_back(box);
    const ModelId pole =
        world.AddModel({Block{test::Square(0.02), {0.0, 0.05}}, Block{Box(-0.08, -0.08, 0.08, 0.08), {0.05, 0.15}}},
                       {0.34, 0.0, 0.2, 0.0});
    world.model(pole).gripper_return = true;
    world.world.objects.push_back(pole);
  }

  GripperWorld world;
  GripperRobot robot;
};

class HeightTable : public testing::TestWithParam<std::tuple<PartCase, HeightCase>> {};

TEST_P(HeightTable, DecidesTheContact) {
  const auto& [part, height] = GetParam();
  HeightWorld scene;
  const double wall = 1.0;  // m ahead
  const ZRange z = height.obstacle(part.z);
  scene.world.AddModel(Box(wall, -1.0, wall + 0.05, 1.0), z);
  GripperRun run(scene.world.world);
  run.Step({{.fingers = 0.05}}, 30);
  run.Step({{.lift = 0.5}}, 30);
  ASSERT_EQ(run.object(ObjectId(0)).mode, ObjectMode::kHeld);
  ASSERT_EQ(run.object(ObjectId(1)).support, scene.world.world.objects[0]);
  ASSERT_NEAR(run.object(ObjectId(0)).X_WO.z, 1.5, 1e-9);
  // The part farthest ahead of those at this height hits the obstacle.
  double front = 0.0;
  for (const PartCase& other : kParts) {
    if (other.z.Overlaps(z)) front = std::max(front, other.front);
  }
  ASSERT_EQ(height.meets, part.z.Overlaps(z));
  run.Step({{.twist = {0.5, 0.0, 0.0}}}, 40);
  if (front == 0.0) {
    EXPECT_FALSE(run.state.robots[0].stalled);
    EXPECT_NEAR(run.state.robots[0].X_WR.x, 2.0, 1e-9) << "drives through under or over it";
  } else {
    EXPECT_TRUE(run.state.robots[0].stalled);
    EXPECT_NEAR(run.state.robots[0].X_WR.x, wall - front, 1e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryPartAndHeight, HeightTable,
                         testing::Combine(testing::ValuesIn(kParts), testing::ValuesIn(kCases)), [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + "_" + std::get<1>(test.param).name;
                         });

}  // namespace
}  // namespace troupe
