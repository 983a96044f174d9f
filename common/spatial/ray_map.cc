#include "common/spatial/ray_map.h"

#include <cstdlib>
#include <cstring>
#include <new>

namespace troupe {
namespace {

static_assert(sizeof(RayPiece) == sizeof(Rectangle) + sizeof(ZRange) + sizeof(ModelId) + 3 * sizeof(std::uint32_t));

constexpr std::size_t kAlignment = alignof(RayPiece);

std::size_t RoundedUp(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace

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
  auto* const block = static_cast<std::byte*>(std::aligned_alloc(kAlignment, size_));
  if (block == nullptr) throw std::bad_alloc();
  block_ = std::shared_ptr<const std::byte>(block, std::free);
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
  block_ = std::move(equal);
  PlaceArrays();
}

}  // namespace troupe
