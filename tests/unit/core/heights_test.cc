// Collision at every height: each part of a robot against obstacles in every relation of their height interval to the
// part's. The part decides; the rest of the robot is beside the obstacle or over it.
#include <gtest/gtest.h>

#include "tests/support/gripper_world.h"

namespace troupe {
namespace {

using test::Box;
using test::GripperRobot;
using test::GripperRun;
using test::GripperWorld;

// The relation of an obstacle's interval to the interval [a, b) of the part.
struct HeightCase {
  const char* name;
  // From the part's interval, the obstacle's.
  ZRange (*obstacle)(const ZRange& part);
  bool meets;
};

constexpr double kHair = 1e-6;  // m: overlaps far beyond rounding

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
       return ZRange{p.min - 0.02, p.min + kHair};
     },
     true},
    {"just_overlapping_from_above",
     [](const ZRange& p) {
       return ZRange{p.max - kHair, p.max + 0.02};
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
  // Of all parts at this height, the one farthest ahead hits the obstacle.
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
