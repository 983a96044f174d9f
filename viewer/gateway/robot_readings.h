// RobotReadings: the readings of robots that viewers have selected, measured in the gateway: the same bits as in the
// robots' agents, because a reading is a pure function of the state.
//
// Threads: one at a time.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "common/sensing/sensor_suite.h"
#include "common/spatial/body_index.h"

namespace troupe {

class RobotReadings {
 public:
  // Until the next call the readings are of this state. The scene and the state must outlive the use.
  void SetState(const std::shared_ptr<const Scene>& scene, const WorldState& state);

  // The encoded readings of a robot in the state, measured now if need be. REQUIRES: SetState was called; the robot
  // exists.
  const std::string& Of(RobotId robot);

 private:
  std::shared_ptr<const Scene> scene_;
  const WorldState* state_ = nullptr;
  std::optional<BodyIndex> bodies_;
  bool bodies_fresh_ = false;
  std::map<RobotId, SensorSuite> suites_;   // made on first use
  std::map<RobotId, std::string> encoded_;  // in the state
};

}  // namespace troupe
