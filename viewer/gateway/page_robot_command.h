// The command of a robot in a request of the page:
//   "twist": [vx, vy, wz], "grippers": [{"gripper": 0, "opening": percent, "lift": percent}],
//   "goal": {"waypoints": [[x, y], ...], "heading": h}
// Each part may be missing, as may opening, lift and heading. A goal without waypoints cancels the goal.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "troupe/result.h"
#include "troupe/robot_command.h"

namespace troupe {

// `object`: the request. The run's service compares the command with its world.
Result<RobotCommand> ParsePageRobotCommand(const nlohmann::json& object);

}  // namespace troupe
