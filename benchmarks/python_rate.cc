// The C++ side of python_rate.py: drives all robots by their ranges, and prints robot-steps in a second of processor
// time and the state hash.
//   python_rate SCENARIO TICKS
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "troupe/simulation.h"

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: python_rate SCENARIO TICKS\n"), 2;
  troupe::Result<troupe::Simulation> loaded = troupe::Simulation::Load(argv[1]);
  if (!loaded.ok()) return std::fprintf(stderr, "%s\n", loaded.error().ToString().c_str()), 2;
  troupe::Simulation& simulation = loaded.value();
  const std::size_t robots = simulation.world().robots.size();
  const int ticks = std::atoi(argv[2]);
  const std::clock_t begin = std::clock();
  for (int tick = 0; tick < ticks; ++tick) {
    for (std::size_t i = 0; i < robots; ++i) {
      double nearest = 1e9;  // m
      for (const double range : simulation.Read(troupe::RobotId(i), 0).ranger()->ranges) {
        nearest = std::min(nearest, range);
      }
      const bool free = nearest > 0.5;
      const troupe::Status status = simulation.DriveBy(troupe::RobotId(i), {free ? 0.4 : 0.0, 0.0, free ? 0.0 : 0.8});
      if (!status.ok()) return 3;
    }
    simulation.Step();
  }
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("%.0f %016llx\n", static_cast<double>(robots) * ticks / seconds,
              static_cast<unsigned long long>(simulation.state_hash()));
  return 0;
}
