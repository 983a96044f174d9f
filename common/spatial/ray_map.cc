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

template <typename T>
std::size_t BytesOf(const std::vector<T>& array) {
  return RoundedUp(array.size() * sizeof(T));
}

}  // namespace

RayMap::RayMap(const RayMapArrays& arrays)
    : size_(BytesOf(arrays.pieces) + BytesOf(arrays.vertices) + BytesOf(arrays.cell_start) +
            BytesOf(arrays.cell_pieces) + BytesOf(arrays.filled)) {
  if (size_ == 0) return;
  auto* const block = static_cast<std::byte*>(std::aligned_alloc(kAlignment, size_));
  if (block == nullptr) throw std::bad_alloc();
  block_ = std::shared_ptr<const std::byte>(block, std::free);
  std::memset(block, 0, size_);  // between the arrays
  std::size_t offset = 0;
  const auto add = [&](const auto& array, auto& view) {
    if (!array.empty())
      std::memcpy(block + offset, static_cast<const void*>(array.data()), std::span(array).size_bytes());
    view = {array.data(), array.size()};  // its length, for PlaceArrays
    offset += BytesOf(array);
  };
  add(arrays.pieces, pieces_);
  add(arrays.vertices, vertices_);
  add(arrays.cell_start, cell_start_);
  add(arrays.cell_pieces, cell_pieces_);
  add(arrays.filled, filled_);
  PlaceArrays();
}

void RayMap::PlaceArrays() {
  const std::byte* next = block_.get();
  const auto place = [&next]<typename T>(std::span<const T>& view) {
    view = {reinterpret_cast<const T*>(next), view.size()};
    next += RoundedUp(view.size_bytes());
  };
  place(pieces_);
  place(vertices_);
  place(cell_start_);
  place(cell_pieces_);
  place(filled_);
}

void RayMap::Share(const FindEqualMemory& find) {
  if (block_ == nullptr || !find) return;
  std::shared_ptr<const std::byte> equal = find(bytes());
  if (equal == nullptr) return;
  block_ = std::move(equal);
  PlaceArrays();
}

}  // namespace troupe
