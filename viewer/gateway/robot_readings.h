// RobotReadings: the readings of robots that viewers have selected, measured in the gateway: the same bits as in the
// robots' agents, because a reading is a pure function of the state.
//
// Threads: one at a time.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "common/spatial/body_index.h"
#include "viewer/gateway/byte_writer.h"
#include "viewer/gateway/past_states.h"

namespace troupe {

// Whether the camera images of a robot are measured: they are large.
enum class Pictures : std::uint8_t {
  kNone,      // the page does not show them
  kKept,      // it shows the last ones, until it receives others
  kMeasured,  // of the state
};

class RobotReadings {
 public:
  // Until the next call the readings are of this state.
  void SetState(const std::shared_ptr<const ViewedState>& state);

  // Writes the readings of a robot in the state, measured now if need be. Returns true if the robot has a camera whose
  // image is not among them. REQUIRES: SetState was called; the robot exists.
  bool Write(ByteWriter& writer, RobotId robot, Pictures pictures);

 private:
  struct Robot {
    SensorSuite suite;
    std::vector<std::string> encoded;  // by sensor, in the state; empty: not measured yet
  };
  const std::string& Encoded(Robot& robot, std::size_t sensor);

  std::shared_ptr<const ViewedState> state_;
  std::optional<BodyIndex> bodies_;
  bool bodies_fresh_ = false;
  std::map<RobotId, Robot> robots_;  // made on first use
};

}  // namespace troupe
