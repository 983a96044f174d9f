#include "world-service/core/lowest_point.h"

#include <algorithm>
#include <optional>

#include "common/spatial/body_index.h"

namespace troupe {

double LowestPoint(const Scene& scene, const WorldState& state, ModelId root) {
  std::optional<double> lowest;
  const auto consider = [&lowest](const ConvexPiece& piece) {
    lowest = std::min(lowest.value_or(piece.z.min), piece.z.min);
  };
  const std::optional<BodyId> body = scene.body_of(root);
  if (!body) {
    scene.static_index().ForEachPiece([&](const ConvexPiece& piece) {
      if (IsInTree(scene.world(), piece.model, root)) consider(piece);
    });
    return lowest.value_or(scene.world().model(root).X_PM.z);
  }
  BodyIndex bodies(scene);
  bodies.Assign(state);
  for (const ConvexPiece& piece : bodies.pieces_in_world(*body)) consider(piece);
  return lowest.value_or(bodies.X_WB(*body).z);
}

}  // namespace troupe
