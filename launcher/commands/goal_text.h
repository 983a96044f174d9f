// ParseGoalText: the points of a goal on a command line.
#pragma once

#include <string>
#include <vector>

#include "troupe/result.h"
#include "troupe/robot_command.h"

namespace troupe {

// Reads "X,Y" of each point, and of the last one "X,Y" or "X,Y,HEADING", in metres and degrees. REQUIRES: not empty
Result<Goal> ParseGoalText(const std::vector<std::string>& points);

}  // namespace troupe
