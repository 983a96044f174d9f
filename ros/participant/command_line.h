// The command line of the program ros-participant.
#pragma once

#include <variant>

#include "ros/messages/ros_options.h"

namespace troupe {

struct ParticipantCommandLine {
  ros::RosOptions ros;
};

// The exit status where the program ends at once.
std::variant<ParticipantCommandLine, int> ParseParticipantCommandLine(int argc, const char* const* argv);

}  // namespace troupe
