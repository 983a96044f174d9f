// Signals: numbers of robots over time, for plots. A signal is a function of a state, so that it is known of every
// state that the past has.
//   x y z heading                 of the pose in the world; m, rad
//   vx vy wz speed                of the executed twist; m/s, rad/s; speed: along both
//   stalled                       0 or 1
//   energy charge                 of all stores of the robot that can be empty; J, W
//   joint/NAME                    the position of a joint; m or rad
//   range/SENSOR, range/SENSOR/I  the nearest range of a ranger, and that of ray I of its first scan; m
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "common/spatial/body_index.h"
#include "viewer/gateway/past_states.h"

namespace troupe {

struct SignalName {
  std::string robot;
  std::string signal;
  auto operator<=>(const SignalName&) const = default;
};

// The stores of each robot that can be empty, by RobotId: indices in WorldState::stores.
std::vector<std::vector<std::size_t>> StoresOfRobots(const WorldDescription& world);

// Threads: one at a time.
class SignalReader {
 public:
  // Until the next call the values are of this state.
  void SetState(const std::shared_ptr<const ViewedState>& state);
  // NaN: the state has no such robot or part. REQUIRES: SetState was called.
  double Value(const SignalName& name);

 private:
  enum class Kind : std::uint8_t {
    kNone,
    kX,
    kY,
    kZ,
    kHeading,
    kVx,
    kVy,
    kWz,
    kSpeed,
    kStalled,
    kEnergy,
    kCharge,
    kJoint,
    kRange
  };
  struct Source {
    Kind kind = Kind::kNone;
    RobotId robot;
    std::size_t part = 0;                 // joint, or sensor of the robot
    std::optional<std::size_t> ray = {};  // nothing: the nearest
  };

  Source Find(const SignalName& name);
  double Range(const Source& source);
  SensorSuite& SuiteOf(RobotId robot);

  std::shared_ptr<const ViewedState> state_;
  std::map<SignalName, Source> sources_;  // in the world of the state, as the next
  std::vector<std::vector<std::size_t>> stores_;
  std::map<RobotId, SensorSuite> suites_;
  std::optional<BodyIndex> bodies_;
  bool bodies_fresh_ = false;
};

}  // namespace troupe
