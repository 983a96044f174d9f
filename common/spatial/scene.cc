#include "common/spatial/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace troupe {

Scene::Scene(WorldDescription world) : world_(std::move(world)) {
  const std::size_t count = world_.models.size();
  robot_of_.resize(count);
  X_FM_.resize(count);
  bodies_.resize(world_.robots.size());
  for (std::size_t i = 0; i < world_.robots.size(); ++i) {
    robot_of_[world_.robots[i].root.index()] = RobotId(i);
    bodies_[i].z = {0.0, 0.0};
  }

  std::vector<ConvexPiece> standing;
  for (std::size_t i = 0; i < count; ++i) {
    const ModelDescription& model = world_.models[i];
    if (model.parent) {
      robot_of_[i] = robot_of_[model.parent->index()];
      X_FM_[i] = X_FM_[model.parent->index()] * model.X_PM;
    } else {
      X_FM_[i] = robot_of_[i] ? Pose{} : model.X_PM;
    }
    std::vector<ConvexPiece> pieces = MakePieces(world_, ModelId(i), X_FM_[i]);
    std::vector<ConvexPiece>& all = robot_of_[i] ? bodies_[robot_of_[i]->index()].pieces : standing;
    std::move(pieces.begin(), pieces.end(), std::back_inserter(all));
  }
  static_index_ = StaticIndex(std::move(standing));

  for (RobotBody& body : bodies_) {
    for (std::size_t i = 0; i < body.pieces.size(); ++i) {
      const ConvexPiece& piece = body.pieces[i];
      body.z.min = i == 0 ? piece.z.min : std::min(body.z.min, piece.z.min);
      body.z.max = i == 0 ? piece.z.max : std::max(body.z.max, piece.z.max);
      for (const Vec2& vertex : piece.vertices) body.radius = std::max(body.radius, vertex.norm());
    }
    max_body_radius_ = std::max(max_body_radius_, body.radius);
  }
}

}  // namespace troupe
