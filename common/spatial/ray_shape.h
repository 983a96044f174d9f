// RayShape: the pieces of a body that rays see, kept once for all bodies of the same shape and close together in
// memory. A swarm has few shapes, and a process that reads them only now and then finds few of them in a cache.
//
// RayShapes has each shape once: bodies with equal pieces have the same number, which a map from all numbers of a shape
// to it finds. RayMap is the same idea for static models: one block of bytes without pointers, equal in all processes
// of a world, so that they can map one copy of it (shared memory).
//
// Invariants: pieces of models that rays do not see are left out; a polygon's first vertex is stored once more behind
// the last, so that an edge is always two neighbours; the arrays of a RayMap are aligned to lines of a cache, and the
// bytes between them are 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "common/base/hash.h"
#include "troupe/ids.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"
#include "troupe/z_range.h"

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace troupe {

// Four numbers at a time: the vector extensions of GCC and Clang, which every processor has some instructions for.

using Float4 [[gnu::vector_size(16)]] = float;
using Bits4 [[gnu::vector_size(16)]] = std::int32_t;  // the result of a comparison: all bits of a lane, or none

inline Float4 LoadFour(const float* numbers) {
  Float4 four;
  std::memcpy(&four, numbers, sizeof four);
  return four;
}

// Bit i: lane i is true.
inline std::uint32_t BitsOf(const Bits4& lanes) {
#ifdef __SSE__
  return static_cast<std::uint32_t>(_mm_movemask_ps(__m128(lanes)));
#else
  return static_cast<std::uint32_t>((lanes[0] & 1) | (lanes[1] & 2) | (lanes[2] & 4) | (lanes[3] & 8));
#endif
}

struct Body;

struct RayShape {
  struct Piece {
    ZRange z;  // m, in the frame of its link, like the vertices
    std::uint32_t link;
    std::uint32_t number;  // in Body::pieces
    std::uint32_t first_vertex;
    std::uint32_t vertex_count;
    std::uint32_t first_corner;  // in corners
    Rectangle box;               // m, around the vertices
  };
  // Four vertices in single precision.
  struct Corners {
    Float4 x;  // m
    Float4 y;
  };
  // The edges by which a line passes a piece; edge i leads from vertex i to the next.
  struct Passage {
    enum class Kind { kApart, kThrough, kUnclear } kind;  // kUnclear: too near to a vertex to decide
    std::uint32_t enter = 0;                              // edges, if kThrough
    std::uint32_t leave = 0;
  };

  std::vector<Piece> pieces;
  std::vector<Vec2> vertices;    // of each piece, counter-clockwise, then its first once more
  std::vector<Corners> corners;  // of each piece, the last four filled up
  double radius = 0.0;           // m, more than the body's by a tolerance, because moving it rounds
  ZRange z;                      // m, the body's

  std::span<const Vec2> vertices_of(const Piece& piece) const {
    return {vertices.data() + piece.first_vertex, piece.vertex_count};
  }
  // `direction`: of length 1, in the frame of the piece's link; `across`: m, the distance of the line to the left of
  // that frame's origin, which is Cross(direction, a point of the line). Never wrong by rounding.
  Passage Pass(const Piece& piece, const Vec2& direction, double across) const;
};

// Shapes by number, each once.
class RayShapes {
 public:
  // The number of the body's shape.
  std::uint32_t Add(const Body& body);
  const RayShape& operator[](std::uint32_t number) const { return shapes_[number]; }

 private:
  std::vector<RayShape> shapes_;
  std::map<std::vector<double>, std::uint32_t> numbers_;  // by all that makes a shape
};

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

// RayMap: the part of a static index that rays read, in one block of memory.
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
  const std::uint8_t* filled() const { return filled_.data(); }  // by cell

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
