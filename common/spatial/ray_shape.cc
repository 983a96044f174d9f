#include "common/spatial/ray_shape.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <new>

#include "common/spatial/scene.h"

namespace troupe {
namespace {

// All that rays read of a shape; models are not in it, because they are found by the number of the piece in its body.
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

bool IsOneBit(std::uint32_t bits) {
  return (bits & (bits - 1)) == 0;
}

static_assert(sizeof(RayPiece) == sizeof(Rectangle) + sizeof(ZRange) + sizeof(ModelId) + 3 * sizeof(std::uint32_t));

constexpr std::size_t kAlignment = alignof(RayPiece);

std::size_t RoundedUp(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace

RayShape::Passage RayShape::Pass(const Piece& piece, const Vec2& direction, double across) const {
  using Kind = Passage::Kind;
  constexpr std::uint32_t kBits = 32;
  if (piece.vertex_count > kBits) return {Kind::kUnclear};
  // All numbers of the pieces near a line are of the size of the body, so they are exact enough by far.
  const auto margin = static_cast<float>(1e-6 * (radius + std::abs(across)) + 1e-7);  // m
  const auto dx = static_cast<float>(direction.x());
  const auto dy = static_cast<float>(direction.y());
  const auto offset = static_cast<float>(across);
  std::uint32_t left = 0;
  std::uint32_t right = 0;
  const Corners* group = corners.data() + piece.first_corner;
  for (std::uint32_t i = 0; i < piece.vertex_count; i += 4, ++group) {
    const Float4 side = dx * group->y - dy * group->x - offset;
    left |= BitsOf(side > margin) << i;
    right |= BitsOf(side < -margin) << i;
  }
  const std::uint32_t last = piece.vertex_count - 1;
  const std::uint32_t all = (std::uint32_t{2} << last) - 1;
  left &= all;
  right &= all;
  if (left == all || right == all) return {Kind::kApart};
  if ((left | right) != all) return {Kind::kUnclear};
  // Bit i of these: vertex i + 1, or the first after the last.
  const std::uint32_t left_next = left >> 1 | left << last;
  const std::uint32_t right_next = right >> 1 | right << last;
  // The line enters where the outline, which runs counter-clockwise, passes from its left to its right.
  const std::uint32_t to_right = left & right_next;
  const std::uint32_t to_left = right & left_next;
  if (!IsOneBit(to_right) || !IsOneBit(to_left)) return {Kind::kUnclear};
  const auto enter = static_cast<std::uint32_t>(std::countr_zero(to_right));
  const auto leave = static_cast<std::uint32_t>(std::countr_zero(to_left));
  return {Kind::kThrough, enter, leave};
}

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
                            .first_corner = static_cast<std::uint32_t>(shape.corners.size()),
                            .box = BoundingBox(piece.vertices)});
    shape.vertices.insert(shape.vertices.end(), piece.vertices.begin(), piece.vertices.end());
    shape.vertices.push_back(piece.vertices.front());
    for (std::size_t v = 0; v < piece.vertices.size(); ++v) {
      if (v % 4 == 0) shape.corners.emplace_back();
      const Vec2& vertex = piece.vertices[v];
      shape.corners.back().x[v % 4] = static_cast<float>(vertex.x());
      shape.corners.back().y[v % 4] = static_cast<float>(vertex.y());
    }
  }
  const auto [place, is_new] = numbers_.emplace(KeyOf(shape), static_cast<std::uint32_t>(shapes_.size()));
  if (is_new) shapes_.push_back(std::move(shape));
  return place->second;
}

template <typename Visit>
void RayMap::ForEachArray(Visit visit) {
  visit(pieces_);
  visit(vertices_);
  visit(cell_start_);
  visit(cell_pieces_);
  visit(filled_);
}

RayMap::RayMap(const RayMapArrays& arrays)
    : pieces_(arrays.pieces),
      vertices_(arrays.vertices),
      cell_start_(arrays.cell_start),
      cell_pieces_(arrays.cell_pieces),
      filled_(arrays.filled) {
  ForEachArray([this](const auto& array) { size_ += RoundedUp(array.size_bytes()); });
  if (size_ == 0) return;
  // By operator new, so that it is in shared memory with all else of its scene (transport/shared_memory).
  constexpr std::align_val_t kAligned{kAlignment};
  auto* const block = static_cast<std::byte*>(::operator new(size_, kAligned));
  block_ = std::shared_ptr<const std::byte>(block, [](std::byte* unused) { ::operator delete(unused, kAligned); });
  // Equal worlds have equal bytes.
  std::memset(block, 0, size_);  // between the arrays
  std::byte* next = block;
  ForEachArray([&next](const auto& array) {
    if (!array.empty()) std::memcpy(next, static_cast<const void*>(array.data()), array.size_bytes());
    next += RoundedUp(array.size_bytes());
  });
  PlaceArrays();
}

void RayMap::PlaceArrays() {
  const std::byte* next = block_.get();
  ForEachArray([&next]<typename T>(std::span<const T>& array) {
    array = {reinterpret_cast<const T*>(next), array.size()};
    next += RoundedUp(array.size_bytes());
  });
}

void RayMap::Share(const FindEqualMemory& find) {
  if (block_ == nullptr || !find) return;
  std::shared_ptr<const std::byte> equal = find(bytes());
  if (equal == nullptr) return;
  // Of equal size and content: only the places of the arrays change.
  block_ = std::move(equal);
  PlaceArrays();
}

}  // namespace troupe
