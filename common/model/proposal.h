// Proposal: what a robot's agent asks for in the next tick. The step decides what of it happens.
#pragma once

#include "common/base/ids.h"
#include "common/geometry/pose.h"

namespace troupe {

struct Proposal {
  RobotId robot;
  Twist twist;  // in R, held through the tick
  bool operator==(const Proposal&) const = default;
};

}  // namespace troupe
