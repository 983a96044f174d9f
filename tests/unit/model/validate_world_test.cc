#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/support/ray_sensors.h"
#include "tests/support/test_world.h"
#include "troupe/world_description.h"

namespace troupe {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Model 0 is static; model 1 is robot 0's root, model 2 its ranger; model 3 is robot 1's root.
WorldDescription GoodWorld() {
  test::TestWorld test;
  test.AddModel(test::Square(3.0), {0.0, 0.1}, {1.0, 1.0, 0.0, 0.5});
  test.AddRobot(test::Square(0.4), {0.0, 0.5}, {5.0, 6.0, 0.0, 1.0});
  const ModelId laser = test.AddModel(std::vector<Block>{}, {0.1, 0.0, 0.5, 0.0}, ModelId(1));
  test.AddRobot(test::Square(0.4), {0.0, 0.5}, {7.0, 6.0, 0.0, 1.0});
  test.world.robots[0].sensors = {
      {.name = "ranger:0", .model = laser, .period_ticks = 1, .parameters = RangerParameters{{{}}}}};
  test.world.shapes[0].rectangles = {{0.0, 0.0, 1.0, 1.0}};
  return test.world;
}

TEST(Validate, AcceptsAGoodWorld) {
  const Status problem = Validate(GoodWorld());
  EXPECT_TRUE(problem.ok()) << problem.error().message;
  EXPECT_TRUE(Validate(WorldDescription{}).ok()) << "an empty description is valid, too";
}

struct Fault {
  std::function<void(WorldDescription&)> change;
  const char* message;
};

const Fault kFaults[] = {
    {[](auto& w) { w.interval_ns = 0; }, "found a tick of 0 ns, expected 1 to 1000000000000"},
    {[](auto& w) { w.interval_ns = -5; }, "found a tick of -5 ns, expected 1 to 1000000000000"},
    {[](auto& w) { w.shapes[0].blocks[0].outline.resize(2); },
     "shape 0: the outline of a block is not usable: found 2 vertices, expected at least 3"},
    {[](auto& w) { std::swap(w.shapes[0].blocks[0].outline[0], w.shapes[0].blocks[0].outline[2]); },
     "shape 0: the outline of a block is not normalized"},
    {[](auto& w) {
       w.shapes[0].blocks[0].z = {1.0, 0.0};
     },
     "shape 0: the height interval of a block is not finite or upside down"},
    {[](auto& w) { w.shapes[0].rectangles[0].max_x = 0.0; }, "shape 0: a rectangle is not finite or has no area"},
    {[](auto& w) { w.shapes[0].rectangles[0].max_x = kInfinity; }, "shape 0: a rectangle is not finite or has no area"},
    {[](auto& w) { w.shapes[0].rectangles_z.max = kNan; },
     "shape 0: the height interval of the rectangles is not finite or upside down"},
    {[](auto& w) { w.models[0].name = ""; }, "model 0 '': it has no name"},
    {[](auto& w) { w.models[1].name = "m0"; }, "model 1 'm0': another model has the same name"},
    {[](auto& w) { w.models[0].parent = ModelId(0); }, "model 0 'm0': its parent does not precede it"},
    {[](auto& w) { w.models[0].parent = ModelId(9); }, "model 0 'm0': its parent does not precede it"},
    {[](auto& w) { w.models[0].shape = ShapeId(4); }, "model 0 'm0': it names a shape that does not exist"},
    {[](auto& w) { w.models[0].X_PM.x = kNan; }, "model 0 'm0': its pose is not finite or too far away"},
    {[](auto& w) { w.models[0].X_PM.x = 1e7; }, "model 0 'm0': its pose is not finite or too far away"},
    {[](auto& w) { w.models[0].size_x = kInfinity; }, "model 0 'm0': its size is not finite or too large"},
    {[](auto& w) { w.models[0].color.r = kNan; }, "model 0 'm0': its color is not finite"},
    {[](auto& w) { w.models[0].ranger_return = kNan; }, "model 0 'm0': its ranger_return is not finite or too large"},
    {[](auto& w) { w.robots[0].root = ModelId(77); }, "robot 0 'm1': its root model does not exist"},
    {[](auto& w) { w.robots[1] = w.robots[0]; }, "robot 1 'm1': it is not in the order of the root models"},
    {[](auto& w) { w.robots[0].root = ModelId(2); }, "robot 0 'm1': its root model has a parent"},
    {[](auto& w) { w.robots[0].name = "x"; }, "robot 0 'x': its root model has another name: 'm1'"},
    {[](auto& w) { w.robots[0].drive.wheelbase = 0.0; }, "robot 0 'm1': its wheelbase is not a positive number"},
    {[](auto& w) {
       w.robots[0].drive.velocity.x = {1.0, -1.0};
     },
     "robot 0 'm1': its velocity bounds are not intervals"},
    {[](auto& w) { w.robots[0].drive.velocity.x.max = kInfinity; },
     "robot 0 'm1': its velocity bounds are not intervals"},
    {[](auto& w) { w.robots[0].drive.acceleration.y.min = 1.0; },
     "robot 0 'm1': its acceleration bounds are not intervals around 0"},
    {[](auto& w) { w.robots[0].localization.origin.y = kNan; },
     "robot 0 'm1': its localization origin is not finite or too far away"},
    {[](auto& w) { w.robots[0].localization.error_x = kNan; },
     "robot 0 'm1': its odometry errors are not finite or too large"},
    {[](auto& w) { w.robots[0].ros.domain = 231; },
     "robot 0 'm1': found the ROS domain 231, expected at most 230: the ports of a higher one would exceed 65535"},
    {[](auto& w) { w.robots[0].ros.domain = w.robots[1].ros.domain = 5; },
     "found the ROS domain 5 for robot 'm3', which robot 'm1' has already, expected one for each robot"},
    {[](auto& w) { w.robots[0].sensors[0].model = ModelId(0); },
     "robot 0 'm1': its ranger 'ranger:0' is not one of its models"},
    {[](auto& w) { w.robots[0].sensors[0].model = ModelId(50); },
     "robot 0 'm1': its ranger 'ranger:0' is not one of its models"},
    {[](auto& w) { w.robots[0].sensors[0].period_ticks = 0; },
     "robot 0 'm1': its ranger 'ranger:0' has a period of no ticks"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].X_MS.x = kNan; },
     "robot 0 'm1': ranger 'ranger:0': its field 'ray_sensors' has a number that is not finite or too large"},
    {[](auto& w) {
       RaySensors(w.robots[0].sensors[0])[0].range = {-1.0, 1.0};
     },
     "robot 0 'm1': ranger 'ranger:0': the range of a sensor is not an interval from 0 up"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].fov = -0.1; },
     "robot 0 'm1': ranger 'ranger:0': the fov of a sensor is not finite or negative"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].samples = 0; },
     "robot 0 'm1': ranger 'ranger:0': a sensor does not have 1 to 100000 samples"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].samples = 100'001; },
     "robot 0 'm1': ranger 'ranger:0': a sensor does not have 1 to 100000 samples"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].noise_variance = -1.0; },
     "robot 0 'm1': ranger 'ranger:0': the noise of a sensor is not finite or its variance negative"},
};

TEST(Validate, ARemovedRobotHasNoRosDomain) {
  WorldDescription world = GoodWorld();
  world.robots[0].ros.domain = world.robots[1].ros.domain = 5;
  world.models[1].removed = true;
  const Status problem = Validate(world);
  EXPECT_TRUE(problem.ok()) << problem.error().message;
}

TEST(Validate, NamesTheFault) {
  for (const Fault& c : kFaults) {
    WorldDescription world = GoodWorld();
    c.change(world);
    const Status problem = Validate(world);
    ASSERT_FALSE(problem.ok()) << c.message;
    EXPECT_EQ(problem.error().message, c.message);
  }
}

}  // namespace
}  // namespace troupe
