// The run of `troupe run`, for the commands that prepare one.
#pragma once

#include <string>
#include <vector>

#include "launcher/supervise/run_options.h"

namespace troupe {

// Runs a world to its end, and returns the exit status; prints errors, the page's address and the summary.
// `ros_options`: the names of the options about ROS on the command line, which a run without ROS does not have.
int RunWorld(RunOptions options, const std::vector<std::string>& ros_options);

}  // namespace troupe
