#include "common/spatial/ray_shape.h"

#include "common/spatial/scene.h"

namespace troupe {
namespace {

std::vector<double> KeyOf(const RayShape& shape) {
  std::vector<double> key = {shape.radius, shape.z.min, shape.z.max};
  for (const RayShape::Piece& piece : shape.pieces) {
    for (const std::uint32_t number : {piece.link, piece.number, piece.vertex_count}) key.push_back(number);
    key.push_back(piece.z.min);
    key.push_back(piece.z.max);
  }
  for (const Vec2& vertex : shape.vertices) {
    key.push_back(vertex.x());
    key.push_back(vertex.y());
  }
  return key;
}

}  // namespace

std::uint32_t RayShapes::Add(const Body& body) {
  RayShape shape;
  shape.radius = body.radius * (1.0 + 1e-9) + 1e-9;
  shape.z = body.z;
  for (std::size_t i = 0; i < body.pieces.size(); ++i) {
    const ConvexPiece& piece = body.pieces[i];
    if (piece.ranger_return < 0.0) continue;
    shape.pieces.push_back({.z = piece.z,
                            .link = body.piece_links[i],
                            .number = static_cast<std::uint32_t>(i),
                            .first_vertex = static_cast<std::uint32_t>(shape.vertices.size()),
                            .vertex_count = static_cast<std::uint32_t>(piece.vertices.size()),
                            .box = BoundingBox(piece.vertices)});
    shape.vertices.insert(shape.vertices.end(), piece.vertices.begin(), piece.vertices.end());
  }
  const auto [place, is_new] = numbers_.emplace(KeyOf(shape), static_cast<std::uint32_t>(shapes_.size()));
  if (is_new) shapes_.push_back(std::move(shape));
  return place->second;
}

}  // namespace troupe
