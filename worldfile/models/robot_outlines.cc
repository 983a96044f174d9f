#include "worldfile/models/robot_outlines.h"

#include <algorithm>
#include <optional>

#include "common/model/states.h"
#include "common/spatial/convex_piece.h"
#include "troupe/world_state.h"

namespace troupe {

std::vector<RobotOutline> OutlinesOfRobots(const WorldDescription& world) {
  std::vector<RobotOutline> outlines(world.robots.size());
  if (world.robots.empty()) return outlines;
  const std::vector<Pose> poses = ModelPoses(world, PlacedState(world));
  std::vector<std::optional<std::size_t>> robot_of(world.models.size());
  for (std::size_t i = 0; i < world.robots.size(); ++i) robot_of[world.robots[i].root.index()] = i;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.parent && !robot_of[i]) robot_of[i] = robot_of[model.parent->index()];
    if (!robot_of[i] || !model.obstacle_return) continue;
    RobotOutline& outline = outlines[*robot_of[i]];
    const Pose X_RM = Inverse(poses[world.robots[*robot_of[i]].root.index()]) * poses[i];
    for (const ConvexPiece& piece : MakePieces(world, ModelId(i), X_RM)) {
      outline.box.Extend(BoundingBox(piece.vertices));
      for (const Vec2& vertex : piece.vertices) outline.radius = std::max(outline.radius, vertex.norm());
    }
  }
  return outlines;
}

}  // namespace troupe
