#include "tests/faults/small_worlds.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"

namespace troupe::faults {
namespace {

// A radio that loses a few messages, with a delay or without.
void AddRadio(WorldDescription& world, RobotId robot, std::size_t index) {
  RadioParameters radio{.delay = 0.1 * static_cast<double>(index % 3), .loss = 0.2};
  test::AddSensor(world, robot, {0.0, 0.0, 0.4, 0.0}, radio);
}

void AddRobot(SmallWorld& world, const std::string& name, std::size_t index, bool memory) {
  const double angle = 1.7 * static_cast<double>(index);
  const RobotId robot = world.AddRobot(name, {1.2 * std::cos(angle), 1.2 * std::sin(angle), 0.0, 0.7 * angle});
  if (memory && index % 6 != 5 && index % 2 == 1) {
    AddRadio(world.world(), robot, index);
    return world.SetController(robot, kCountingController);
  }
  if (memory && index % 2 == 0) {
    world.AddRanger(robot, {}, {OneRay(2.0)});
    return world.SetController(robot, "wander");
  }
  const double speed = 0.2 + 0.1 * static_cast<double>(index % 4);
  world.SetController(
      robot, "script",
      fmt::format(
          R"({{"repeat": true, "period": 3, "commands": [{{"at": 0, "vx": {}}}, {{"at": {}, "vx": {}, "wz": 1}}]}})",
          speed, 1.1 + 0.2 * static_cast<double>(index % 3), -speed));
}

void AddObject(SmallWorld& world, const std::string& name, double x, double y) {
  world.AddBox(name, x, y, 0.3, 0.3, {0.0, 0.3}).gripper_return = true;
  world.world().objects.emplace_back(world.world().models.size() - 1);
}

WorldDescription Valid(const WorldDescription& world) {
  if (const Status status = Validate(world); !status.ok()) throw std::runtime_error(status.error().message);
  return world;
}

}  // namespace

WorldDescription RunWorld(std::size_t robots, bool memory) {
  SmallWorld world;
  world.AddBox("box", 0.2, 0.1, 0.4, 0.4, {0.0, 0.5});
  AddObject(world, "crate", 2.5, 2.5);
  for (std::size_t i = 0; i < robots; ++i) AddRobot(world, "r" + std::to_string(i), i, memory);
  return Valid(world.world());
}

std::shared_ptr<const WorldDescription> OtherWorld(bool memory) {
  SmallWorld world;
  world.AddBox("box", -0.2, 0.3, 0.5, 0.3, {0.0, 0.5});
  AddRobot(world, "x0", 3, memory);
  AddRobot(world, "r1", 1, memory);
  AddRobot(world, "r0", 0, memory);
  return std::make_shared<const WorldDescription>(Valid(world.world()));
}

std::shared_ptr<const WorldDescription> WorldToSpawn(const std::string& source, bool memory) {
  SmallWorld world;
  if (source == "scout") AddRobot(world, "scout", 2, memory);
  if (source == "crate") AddObject(world, "crate", 0.0, 0.0);
  return std::make_shared<const WorldDescription>(Valid(world.world()));
}

}  // namespace troupe::faults
