// The grippers of a robot of SDF or URDF: two prismatic joints whose links close on each other.
//
// Fingers are joints with limits and a horizontal axis that one link carries, or of which one follows the other
// (`mimic`), with collisions that face each other: at the same height and side by side, in front of each other along
// the axis. Files count fingers either way, towards each other or apart; closing is the direction in which the bodies
// approach each other, at the middle of their travel.
#pragma once

#include <cstddef>
#include <vector>

#include "troupe/interval.h"
#include "worldfile/gazebo/rigid_model.h"

namespace troupe {

struct FingerGuess {
  std::size_t joint = 0;          // in the model
  Interval position;              // m, its limits in the file's sense; of one that follows perhaps those of the other
  bool closes_downwards = false;  // towards the lower limit of the file
};

struct GripperGuess {
  FingerGuess left;  // the one with the greater y, then x, in M
  FingerGuess right;
};

// In the order of the joints; no joint is in two.
std::vector<GripperGuess> GuessGrippers(const RigidModel& model);

}  // namespace troupe
