#include "common/spatial/convex_piece.h"

#include <algorithm>

#include "common/geometry/convex_partition.h"

namespace troupe {
namespace {

ConvexPiece Moved(std::vector<Vec2> vertices, const ZRange& z, const ModelDescription& model, ModelId id,
                  const Pose& X_FM) {
  const Transform2 transform(X_FM);
  for (Vec2& vertex : vertices) vertex = transform * vertex;
  return {.vertices = std::move(vertices),
          .z = z + X_FM.z,
          .model = id,
          .obstacle = model.obstacle_return,
          .ranger_return = model.ranger_return};
}

}  // namespace

bool HasHeight(const ZRange& z) {
  return z.max - z.min > kTouchTolerance;
}

bool IsBox(std::span<const Vec2> vertices) {
  if (vertices.size() != 4) return false;
  const Rectangle box = BoundingBox(vertices);
  return std::all_of(vertices.begin(), vertices.end(), [&](const Vec2& p) {
    return (p.x() == box.min_x || p.x() == box.max_x) && (p.y() == box.min_y || p.y() == box.max_y);
  });
}

std::vector<ConvexPiece> MakePieces(const WorldDescription& world, ModelId id, const Pose& X_FM) {
  const ModelDescription& model = world.model(id);
  const Shape& shape = world.shape(model.shape);
  std::vector<ConvexPiece> pieces;
  for (const Block& block : shape.blocks) {
    if (!HasHeight(block.z)) continue;
    for (Polygon& part : ConvexPartition(block.outline)) {
      pieces.push_back(Moved(std::move(part), block.z, model, id, X_FM));
    }
  }
  if (HasHeight(shape.rectangles_z)) {
    pieces.reserve(pieces.size() + shape.rectangles.size());
    for (const Rectangle& r : shape.rectangles) {
      const std::array<Vec2, 4> corners = Corners(r);
      pieces.push_back(Moved({corners.begin(), corners.end()}, shape.rectangles_z, model, id, X_FM));
    }
  }
  return pieces;
}

ConvexPiece Transformed(const ConvexPiece& piece, const Pose& X_WF) {
  ConvexPiece result = piece;
  const Transform2 transform(X_WF);
  for (Vec2& vertex : result.vertices) vertex = transform * vertex;
  result.z = piece.z + X_WF.z;
  return result;
}

}  // namespace troupe
