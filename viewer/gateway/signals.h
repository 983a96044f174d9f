// Signals over time, for plots: numbers of a state, so that they are known of every state that the past has.
// - a signal of a thing of the state's tables (common/signals), as ["front door", "opening"]
// - ["transmissions", "count"]: the number of rows of a table
// - ["r0", "range/SENSOR"], ["r0", "range/SENSOR/I"]: the nearest range of a ranger, and that of ray I of its first
//   scan; m
//
// Names are looked up once per world and then are positions of rows, because a plot asks for thousands of states.
// Ranges are measured from the state when a plot asks for them: they cost as much as in the agent.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "common/signals/state_tables.h"
#include "common/spatial/body_index.h"
#include "recording/timeline/timeline.h"

namespace troupe {

// Of several things of that name with such a signal, the one whose table is first.
struct SignalName {
  std::string thing;
  std::string signal;
  auto operator<=>(const SignalName&) const = default;
};

// Threads: one at a time.
class SignalReader {
 public:
  // Until the next call the values are of this state.
  void SetState(const SharedState& state);
  // NaN: the state has no such thing or signal. REQUIRES: SetState was called, here and below
  double Value(const SignalName& name);
  // What can be plotted: [{"name", "singular", "things": [names, at most kMaxThings], "signals": [{"name", "unit",
  // "documentation"}]}] of each table of the state.
  nlohmann::json Describe() const;

  static constexpr std::size_t kMaxThings = 1000;  // of a table

 private:
  struct Ray {
    RobotId robot;
    std::size_t sensor = 0;               // of the robot
    std::optional<std::size_t> ray = {};  // nothing: the nearest
  };
  // Where a signal is in the world of the state: found once, used for each state.
  struct Source {
    const StateTable* table = nullptr;  // null: a range, or none
    const Signal* signal = nullptr;     // of the table; null: the number of its rows
    std::size_t row = 0;
    std::optional<Ray> range = {};
  };

  Source Find(const SignalName& name);
  std::optional<Ray> FindRange(const SignalName& name);
  double Range(const Ray& source);
  SensorSuite& SuiteOf(RobotId robot);

  SharedState state_;
  std::map<SignalName, Source> sources_;  // in the world of the state, as the next
  std::optional<Things> things_;
  std::map<RobotId, SensorSuite> suites_;
  std::optional<BodyIndex> bodies_;
  bool bodies_fresh_ = false;
};

}  // namespace troupe
