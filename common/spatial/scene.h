// Scene: a world description prepared for fast questions. Immutable; made once by the service and once by each agent.
#pragma once

#include <memory>
#include <vector>

#include "common/base/ids.h"
#include "common/model/world_description.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/static_index.h"

namespace troupe {

// What moves with a robot: its root model and everything below, as pieces in R.
struct RobotBody {
  std::vector<ConvexPiece> pieces;
  double radius = 0.0;  // m: every vertex is within this distance of R's origin
  ZRange z;             // m, spans all pieces, in R
};

class Scene {
 public:
  // REQUIRES: Validate(world) found nothing.
  explicit Scene(WorldDescription world);

  const WorldDescription& world() const { return world_; }
  const StaticIndex& static_index() const { return static_index_; }
  const RobotBody& body(RobotId robot) const { return bodies_[robot.index()]; }
  // The robot whose tree the model belongs to; nothing for a model that stands still.
  std::optional<RobotId> robot_of(ModelId model) const { return robot_of_[model.index()]; }
  // Pose of a robot's model in R; REQUIRES: robot_of(model).
  const Pose& X_RM(ModelId model) const { return X_FM_[model.index()]; }
  // The largest of all bodies' radii, m.
  double max_body_radius() const { return max_body_radius_; }

 private:
  WorldDescription world_;
  std::vector<std::optional<RobotId>> robot_of_;
  std::vector<Pose> X_FM_;  // frame F: R for models of robots, W for the others
  std::vector<RobotBody> bodies_;
  StaticIndex static_index_;
  double max_body_radius_ = 0.0;
};

}  // namespace troupe
