// RayShape: the pieces of a body that rays see, kept once for all bodies of the same shape and close together in
// memory. A swarm has few shapes, and a process that reads them only now and then finds few of them in a cache.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "common/spatial/float4.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"
#include "troupe/z_range.h"

namespace troupe {

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
  double radius = 0.0;           // m, a hair more than the body's, because moving it rounds
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

}  // namespace troupe
