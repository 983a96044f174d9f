// The leaves of doors: where they are while closed, and how they open.
#pragma once

#include <vector>

#include "troupe/pose.h"
#include "worldfile/sites/site.h"

namespace troupe {

// The leaf of a door.
struct DoorLeaf {
  Pose X_WH;           // closed; frame H: at the hinge, or at the middle of a leaf that slides; x along the leaf
  double min_x = 0.0;  // m, frame H
  double max_x = 0.0;
  double turn = 0.0;   // rad, to its open position
  double shift = 0.0;  // m, along x

  Pose X_WH_open() const;
};

// The leaves of a door on a level at `elevation`: one or two. REQUIRES: the door's vertices are at different places.
std::vector<DoorLeaf> LeavesOf(const SiteDoor& door, const std::vector<SiteVertex>& vertices, double elevation);

// A leaf that slides by `shift` m. Frame D: at the middle of the doorway; `middle`, `width`: m, the part that it
// closes.
DoorLeaf SlidingLeaf(const Pose& X_WD, double middle, double width, double shift);

}  // namespace troupe
