#include "troupe/world_description.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "common/model/states.h"
#include "tests/support/ray_sensors.h"
#include "tests/support/test_world.h"

namespace troupe {
namespace {

// A world in which every field of a description can be changed.
WorldDescription FullWorld() {
  test::TestWorld test;
  test.world.name = "full";
  const ModelId floor = test.AddModel(test::Square(3.0), {0.0, 0.1}, {1.0, 1.0, 0.0, 0.5});
  test.AddModel(test::Square(0.5), {0.0, 1.0}, {0.5, 0.0, 0.1, 0.25}, floor);
  const RobotId robot = test.AddRobot(test::Square(0.4), {0.0, 0.5}, {5.0, 6.0, 0.0, 1.0});
  const ModelId laser = test.AddModel(test::Square(0.1), {0.0, 0.1}, {0.1, 0.0, 0.5, 0.0}, ModelId(2));
  test.world.shapes[0].rectangles = {{0.0, 0.0, 1.0, 1.0}};
  test.world.shapes[0].rectangles_z = {0.0, 1.0};
  test.world.robots[robot.index()].sensors = {
      {.name = "ranger:0", .model = laser, .period_ticks = 1, .parameters = RangerParameters{{{}}}}};
  return test.world;
}

TEST(ModelPoses, FollowTheTreeAtTheStart) {
  const WorldDescription world = FullWorld();
  const std::vector<Pose> X_WM = ModelPoses(world, PlacedState(world));
  ASSERT_EQ(X_WM.size(), 4u);
  EXPECT_EQ(X_WM[0], (Pose{1.0, 1.0, 0.0, 0.5}));
  EXPECT_EQ(X_WM[1], (X_WM[0] * Pose{0.5, 0.0, 0.1, 0.25}));
  EXPECT_DOUBLE_EQ(X_WM[1].heading, 0.75);
  EXPECT_DOUBLE_EQ(X_WM[1].z, 0.1);
  EXPECT_EQ(X_WM[3], (X_WM[2] * Pose{0.1, 0.0, 0.5, 0.0}));
}

TEST(FindRobot, FindsByName) {
  const WorldDescription world = FullWorld();
  EXPECT_EQ(FindRobot(world, "m2"), RobotId(0));
  EXPECT_EQ(FindRobot(world, "m0"), std::nullopt) << "a model, but no robot";
  EXPECT_EQ(FindRobot(world, ""), std::nullopt);
}

TEST(WorldHash, ChangesWithEveryField) {
  const std::function<void(WorldDescription&)> changes[] = {
      [](WorldDescription&) {},
      [](WorldDescription& w) { w.name = "other"; },
      [](WorldDescription& w) { w.seed = 1; },
      [](WorldDescription& w) { ++w.interval_ns; },
      [](WorldDescription& w) { w.shapes[0].blocks[0].outline[0].x() += 1e-9; },
      [](WorldDescription& w) { w.shapes[0].blocks[0].z.max += 1e-9; },
      [](WorldDescription& w) { w.shapes[0].rectangles[0].max_y += 1e-9; },
      [](WorldDescription& w) { w.shapes[0].rectangles.push_back({}); },
      [](WorldDescription& w) { w.shapes[0].rectangles_z.min = -1.0; },
      [](WorldDescription& w) { w.models[0].name = "x"; },
      [](WorldDescription& w) { w.models[0].type = "x"; },
      [](WorldDescription& w) { w.models[1].parent.reset(); },
      [](WorldDescription& w) { w.models[1].X_PM.z += 1e-9; },
      [](WorldDescription& w) { w.models[1].shape = ShapeId(0); },
      [](WorldDescription& w) { w.models[1].size_x = 1.0; },
      [](WorldDescription& w) { w.models[1].size_y = 1.0; },
      [](WorldDescription& w) { w.models[1].size_z = 1.0; },
      [](WorldDescription& w) { w.models[1].color.a = 0.5; },
      [](WorldDescription& w) { w.models[1].obstacle_return = false; },
      [](WorldDescription& w) { w.models[1].ranger_return = -1.0; },
      [](WorldDescription& w) { w.models[1].gripper_return = true; },
      [](WorldDescription& w) { w.models[1].fiducial_return = -3; },
      [](WorldDescription& w) { w.models[1].show_nose = true; },
      [](WorldDescription& w) { w.robots[0].name = "x"; },
      [](WorldDescription& w) { w.robots[0].root = ModelId(0); },
      [](WorldDescription& w) { w.robots[0].drive.type = DriveType::kCar; },
      [](WorldDescription& w) { w.robots[0].drive.wheelbase = 2.0; },
      [](WorldDescription& w) { w.robots[0].drive.velocity.y.max = 2.0; },
      [](WorldDescription& w) { w.robots[0].drive.acceleration.heading.min = -2.0; },
      [](WorldDescription& w) { w.robots[0].localization.type = LocalizationType::kOdometry; },
      [](WorldDescription& w) { w.robots[0].localization.origin.x = 2.0; },
      [](WorldDescription& w) { w.robots[0].localization.error_heading = 2.0; },
      [](WorldDescription& w) { w.robots[0].sensors[0].name = "x"; },
      [](WorldDescription& w) { w.robots[0].sensors[0].model = ModelId(2); },
      [](WorldDescription& w) { w.robots[0].sensors[0].period_ticks = 2; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].X_MS.x = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].range.max = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].fov = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].samples = 2; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].noise_variance = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].noise_proportional = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].noise_angle = 2.0; },
      [](WorldDescription& w) { w.robots[0].sensors.clear(); },
      [](WorldDescription& w) { w.robots[0].controller.name = "wander"; },
      [](WorldDescription& w) { w.robots[0].controller.parameters = "{\"a\":1}"; },
      [](WorldDescription& w) { w.robots.clear(); },
  };
  std::set<std::uint64_t> hashes;
  for (const auto& change : changes) {
    WorldDescription world = FullWorld();
    change(world);
    EXPECT_TRUE(hashes.insert(Hash(world)).second) << "change " << hashes.size();
  }
  EXPECT_EQ(Hash(FullWorld()), Hash(FullWorld()));
}

}  // namespace
}  // namespace troupe
