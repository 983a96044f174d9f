// RosLockstep: the nodes of ROS for which ticks wait. docs/ros2-lockstep.md explains it.
//
// Values only, read from scenarios and command lines; the observer of ROS (observers/ros) waits. Optional members tell
// "not said" from a value, so that a command line replaces the parts of a scenario that it names and no others. Times
// are wall times: simulated time stands still while a tick waits.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

// Whether the text can be a RosLockstepName: the name of a topic or a node as ROS has it, of letters, digits and
// underscores, no part of it beginning with a digit, and of at most 200 bytes.
Status CheckRosLockstepName(const std::string& name);

// A topic ("/anna/cmd_vel", or "~/cmd_vel" below a robot), or the name by which a node answers on /world/tick_done.
struct RosLockstepName {
  std::string name;
  std::string robot = {};  // in whose ROS domain, and of whom "~" is the namespace; empty: the run's, and all robots
};

struct RosLockstep {
  static constexpr double kDefaultLimitSeconds = 10.0;

  std::vector<RosLockstepName> names = {};
  std::optional<std::uint64_t> period = {};  // ticks between two ticks that wait; nothing: 1
  std::optional<double> limit_seconds = {};  // wall time, for a node that has answered before; 0: none
  std::optional<bool> ends_at_limit = {};    // the run ends at the limit; false: it continues without that node

  // The values that `other` has replace the values here.
  void ReplaceBy(const RosLockstep& other) {
    if (!other.names.empty()) names = other.names;
    if (other.period) period = other.period;
    if (other.limit_seconds) limit_seconds = other.limit_seconds;
    if (other.ends_at_limit) ends_at_limit = other.ends_at_limit;
  }
};

}  // namespace troupe
