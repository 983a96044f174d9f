// Drives the first robot of a world by its ranger, prints its poses and saves a picture:
//   hello_world /usr/share/troupe/worlds/scenarios/demo.json demo.png
#include <troupe/controller.h>
#include <troupe/sensor.h>
#include <troupe/simulation.h>

#include <algorithm>
#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: hello_world WORLD PICTURE\n"), 2;
  troupe::Result<troupe::Simulation> loaded = troupe::Simulation::Load(argv[1]);
  if (!loaded.ok()) return std::fprintf(stderr, "%s\n", loaded.error().ToString().c_str()), 2;
  troupe::Simulation& simulation = loaded.value();
  if (simulation.world().robots.empty() || simulation.world().robots[0].sensors.empty()) {
    return std::fprintf(stderr, "%s has no robot with a ranger\n", argv[1]), 2;
  }
  const troupe::RobotId robot(0);

  for (int i = 0; i < 200; ++i) {
    double nearest = 1e9;  // m
    const troupe::SensorReading reading = simulation.Measure(robot, 0);
    for (const troupe::RangeScan& scan : reading.ranger()->scans()) {
      for (const double range : scan.ranges) nearest = std::min(nearest, range);
    }
    troupe::Command command;
    command.twist.vx = nearest > 0.5 ? 0.4 : 0.0;  // m/s
    command.twist.wz = nearest > 0.5 ? 0.0 : 0.8;  // rad/s
    if (const troupe::Status status = simulation.Drive(robot, command); !status.ok()) return 3;
    simulation.Step();
    if (simulation.tick() % 20 == 0) {
      const troupe::Pose& pose = simulation.pose(robot);
      std::printf("tick %3d: x %6.3f m, y %6.3f m, heading %6.3f rad\n", static_cast<int>(simulation.tick()), pose.x,
                  pose.y, pose.heading);
    }
  }
  const troupe::Status saved = simulation.SavePicture(argv[2]);
  if (!saved.ok()) std::fprintf(stderr, "%s\n", saved.error().ToString().c_str());
  return saved.ok() ? 0 : 3;
}
