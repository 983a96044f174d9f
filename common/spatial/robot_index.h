// RobotIndex: where the robots of a state are, for finding those near a box. Rebuilt or updated as robots move.
//
// Not safe to share between threads, not even for reading: pieces_in_world fills a cache.
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/ids.h"
#include "common/geometry/rectangle.h"
#include "common/model/world_state.h"
#include "common/spatial/grid.h"
#include "common/spatial/scene.h"

namespace troupe {

class RobotIndex {
 public:
  // The scene must outlive the index.
  explicit RobotIndex(const Scene& scene) : scene_(&scene) {}

  // Takes in the poses of all robots. Cheap where they have not moved since the last call.
  void Assign(const WorldState& state);
  // Takes in one robot's new pose. REQUIRES: Assign has been called.
  void Move(RobotId robot, const Pose& X_WR);

  const Pose& X_WR(RobotId robot) const { return X_WR_[robot.index()]; }
  // The robot's pieces in W at its present pose. Valid until the robot is moved.
  const std::vector<ConvexPiece>& pieces_in_world(RobotId robot) const;

  // The robots whose bodies may overlap `box`, in id order without repeats. Appends to `result`.
  void Query(const Rectangle& box, std::vector<RobotId>& result) const;

 private:
  struct Cache {
    std::vector<ConvexPiece> pieces;
    bool fresh = false;
  };

  bool FitsGrid() const;
  void Rebuild();
  void Insert(std::uint32_t robot);
  void Remove(std::uint32_t robot);
  bool MayOverlap(std::uint32_t robot, const Rectangle& box) const;

  const Scene* scene_;
  std::vector<Pose> X_WR_;
  mutable std::vector<Cache> cache_;
  // The robots of a cell are a list: cell_first_, then next_ of each. kNone ends it.
  Grid grid_;
  std::vector<std::uint32_t> cell_first_;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> cell_of_;
};

}  // namespace troupe
