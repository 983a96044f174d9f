// Runs a world of MVSim without windows and without its server for a number of ticks of 0.1 s, with the rule of
// Troupe's `expand` for each vehicle: towards the side with most room, and ahead if the front is clear.
//   mvsim_run WORLD TICKS
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mvsim/VehicleBase.h>
#include <mvsim/World.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

namespace {

constexpr double kTick = 0.1;           // s
constexpr double kSpeed = 0.4;          // m/s, ahead
constexpr double kClearDistance = 0.6;  // m
constexpr double kClearAngle = 0.5;     // rad: bearings within this are ahead
constexpr double kTurnGain = 1.0;       // 1/s

mrpt::math::TTwist2D Command(const mrpt::obs::CObservation2DRangeScan& scan) {
  const std::size_t rays = scan.getScanSize();
  double x = 0.0;
  double y = 0.0;
  bool front_is_clear = true;
  for (std::size_t i = 0; i < rays; ++i) {
    const double bearing = scan.sensorPose.yaw() - 0.5 * scan.aperture + scan.aperture * i / (rays - 1);
    const double range = scan.getScanRange(i);
    x += range * std::cos(bearing);
    y += range * std::sin(bearing);
    if (std::abs(bearing) <= kClearAngle && range < kClearDistance) front_is_clear = false;
  }
  return {front_is_clear ? kSpeed : 0.0, 0.0, kTurnGain * std::atan2(y, x)};
}

int Run(const char* path, int ticks) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  mvsim::World world;
  world.setMinLoggingLevel(mrpt::system::LVL_WARN);
  world.headless(true);
  world.load_from_XML(text.str(), path);
  std::map<const mvsim::Simulable*, mvsim::ControllerBaseInterface*> controllers;
  for (const auto& [name, vehicle] : world.getListOfVehicles())
    controllers[vehicle.get()] = vehicle->getControllerInterface();
  world.registerCallbackOnObservation(
      [&](const mvsim::Simulable& vehicle, const mrpt::obs::CObservation::Ptr& observation) {
        const auto scan = std::dynamic_pointer_cast<mrpt::obs::CObservation2DRangeScan>(observation);
        if (scan) controllers.at(&vehicle)->setTwistCommand(Command(*scan));
      });
  for (int tick = 0; tick < ticks; ++tick) world.run_simulation(kTick);
  std::cout << controllers.size() << " vehicles, steps of " << world.get_simul_timestep() << " s\n";
  return controllers.empty() ? EXIT_FAILURE : EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "error: expected a world and a number of ticks\n";
    return 2;
  }
  try {
    return Run(argv[1], std::atoi(argv[2]));
  } catch (const std::exception& failure) {
    std::cerr << "error: " << failure.what() << '\n';
    return EXIT_FAILURE;
  }
}
