// ParsePoseText: a pose on a command line, with the rule of scenarios: the height may be left out.
#pragma once

#include <string>

#include "troupe/pose.h"
#include "troupe/result.h"

namespace troupe {

struct PoseText {
  Pose X_WE;  // z is 0 if it was left out
  bool has_height = false;
};

// Reads "X,Y,HEADING" or "X,Y,Z,HEADING", in metres and degrees.
Result<PoseText> ParsePoseText(const std::string& text);

}  // namespace troupe
