// RobotIndex: where the robots of a state are, for finding those near a box. Rebuilt or updated as robots move.
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/ids.h"
#include "common/geometry/rectangle.h"
#include "common/model/world_state.h"
#include "common/spatial/scene.h"

namespace troupe {

class RobotIndex {
 public:
  // The scene must outlive the index.
  explicit RobotIndex(const Scene& scene) : scene_(&scene) {}

  // Takes in the poses of all robots.
  void Assign(const WorldState& state);
  // Takes in one robot's new pose.
  void Move(RobotId robot, const Pose& X_WR);

  const Pose& X_WR(RobotId robot) const;
  // The robot's pieces in W at its present pose. Valid until the robot is moved.
  const std::vector<ConvexPiece>& pieces_in_world(RobotId robot) const;

  // The robots whose bodies may overlap `box`, in id order without repeats. Appends to `result`.
  void Query(const Rectangle& box, std::vector<RobotId>& result) const;

 private:
  const Scene* scene_;
};

}  // namespace troupe
