// RayMap: the part of a static index that rays read, in one block of memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/base/equal_memory.h"
#include "troupe/ids.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"
#include "troupe/z_range.h"

namespace troupe {

// A piece as rays need it, small and close to its neighbours in memory: one line of a cache, without unset bytes.
struct alignas(64) RayPiece {
  Rectangle box;  // m, around the piece
  ZRange z;       // m; empty if rays look through the piece
  ModelId model;
  std::uint32_t is_box = 0;  // 1 if the piece fills the box
  std::uint32_t first_vertex = 0;
  std::uint32_t vertex_count = 0;
};

struct RayMapArrays {
  std::vector<RayPiece> pieces;
  std::vector<Vec2> vertices;  // of all pieces, m, frame W
  // The pieces of cell c are cell_pieces[cell_start[c]] up to cell_pieces[cell_start[c + 1]], ascending.
  std::vector<std::uint32_t> cell_start;
  std::vector<std::uint32_t> cell_pieces;
  // 1 for each cell with pieces: rays mostly pass empty cells, and then read nothing else.
  std::vector<std::uint8_t> filled;
};

class RayMap {
 public:
  RayMap() = default;
  explicit RayMap(const RayMapArrays& arrays);

  const RayPiece& piece(std::uint32_t index) const { return pieces_[index]; }
  std::span<const Vec2> vertices(const RayPiece& piece) const {
    return vertices_.subspan(piece.first_vertex, piece.vertex_count);
  }
  std::span<const std::uint32_t> PiecesInCell(std::size_t cell) const {
    return {cell_pieces_.data() + cell_start_[cell], cell_pieces_.data() + cell_start_[cell + 1]};
  }
  std::uint8_t filled(std::size_t cell) const { return filled_[cell]; }

  // The block; equal bytes in all processes with an equal world.
  std::span<const std::byte> bytes() const { return {block_.get(), size_}; }
  // Replaces the block by equal memory, if there is any.
  void Share(const FindEqualMemory& find);

 private:
  // In the order in which the block has them.
  template <typename Visit>
  void ForEachArray(Visit visit);
  // Places the arrays, with their present lengths, in the block.
  void PlaceArrays();

  std::shared_ptr<const std::byte> block_;  // null: empty
  std::size_t size_ = 0;
  std::span<const RayPiece> pieces_;
  std::span<const Vec2> vertices_;
  std::span<const std::uint32_t> cell_start_;
  std::span<const std::uint32_t> cell_pieces_;
  std::span<const std::uint8_t> filled_;
};

}  // namespace troupe
