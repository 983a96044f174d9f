// Controller: what decides how a robot moves. Write one, build it as a shared library, and name it in a scenario; see
// docs/controllers.md and examples/own_controller.
//
// A controller runs in its robot's agent process. Each tick it gets an Observation of the world at tick n and answers
// with the Command for tick n + 1. To keep runs repeatable it must depend on nothing but its observations and
// parameters: no clock, no own random seed (Observation::Random gives repeatable draws).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/base/random.h"
#include "common/geometry/pose.h"
#include "common/model/world_description.h"
#include "robot-agent/controller/manipulation.h"

namespace troupe {

// What one ray sensor measured: ranges[i] (m) and intensities[i] at bearing i; bearings run from -fov/2 to +fov/2.
struct RangeScan {
  std::vector<double> ranges;       // m; a ray that meets nothing reads the sensor's maximum
  std::vector<double> intensities;  // ranger_return of what was met, 0 for nothing
};

// What one ranger of the robot measured: one scan for each of its sensors, in the order of the world file.
struct RangerReading {
  Tick tick = 0;  // when it was measured; a slow ranger keeps its last reading
  std::vector<RangeScan> scans;
};

struct Observation {
  Tick tick = 0;
  double time = 0.0;      // s, simulated
  double interval = 0.0;  // s, length of a tick
  Pose pose_estimate;     // by the robot's localization: frame world (gps) or odom (odometry)
  Twist twist;            // executed during the last tick, in R
  bool stalled = false;
  std::span<const RangerReading> rangers;  // by ranger, as in RobotDescription; empty scans where not subscribed
  std::span<const JointReading> joints;
  std::span<const GripperReading> grippers;
  std::uint64_t random_key = 0;  // of this robot and tick

  // The i-th of this tick's uniform random numbers in [0, 1), the same in every run with the same seed.
  double Random(std::uint64_t i) const { return RandomUniform({random_key, i}); }
};

// What a controller asks for. The drive bounds the motion (common/model/drive_limits.h), which has to be asked for anew
// in each tick; what grippers and joints were told stays until they are told something else.
struct Command {
  Twist twist;            // differential and omni drives, in R
  double speed = 0.0;     // m/s, car drive: speed of the steered wheel
  double steering = 0.0;  // rad, car drive
  // Done in order, grippers first. A number that is not finite, a percentage or position out of range, or a gripper or
  // joint that is not there is a failure of the controller.
  std::vector<GripperCommand> grippers = {};
  std::vector<JointCommand> joints = {};
};

// What a controller may know of its robot before the first tick.
struct RobotInfo {
  const RobotDescription* robot = nullptr;           // never null; lives as long as the controller
  std::string parameters = "{}";                     // a JSON object
  std::vector<Pose> X_RM;                            // by ranger: where it is mounted on the robot
  std::vector<const JointDescription*> joints = {};  // in id order; never null, live as long as the controller
  std::vector<GripperInfo> grippers = {};            // in id order
};

class Controller {
 public:
  virtual ~Controller() = default;

  // Indices of the rangers that Update reads. The others are not computed.
  virtual std::vector<std::size_t> Subscriptions() const { return {}; }

  // Indices of the grippers whose break beams Update reads. The others are not computed.
  virtual std::vector<std::size_t> BeamSubscriptions() const { return {}; }

  // Decides. Called once each tick, in order of ticks; ticks may be missing after the agent was away. An exception
  // stops the robot and is reported; the run goes on.
  virtual Command Update(const Observation& observation) = 0;
};

}  // namespace troupe

// A shared library defines these two (TROUPE_CONTROLLER does it):
//   extern "C" int troupe_controller_abi();
//   extern "C" troupe::Controller* troupe_create_controller(const troupe::RobotInfo& info);   // throws std::exception
#define TROUPE_CONTROLLER_ABI 3
#define TROUPE_CONTROLLER(Type)                                                                   \
  extern "C" __attribute__((visibility("default"))) int troupe_controller_abi() {                 \
    return TROUPE_CONTROLLER_ABI;                                                                 \
  }                                                                                               \
  extern "C" __attribute__((visibility("default"))) troupe::Controller* troupe_create_controller( \
      const troupe::RobotInfo& info) {                                                            \
    return new Type(info);                                                                        \
  }
