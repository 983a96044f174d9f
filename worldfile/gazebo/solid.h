// Solids in space as prisms of 2.5D: blocks that a robot drives around and a ray hits.
//
// A solid is cut into bands of heights; in each band its block is the convex hull of the solid there, so that a block
// is never smaller than the solid, and larger by a measured bound: the greatest distance between the block and the
// solid's own section at the bottom or the top of its band. Bands are halved where the bound is greatest until it is
// small enough, the band is lower than 1 cm, or there are too many. An upright box, cylinder or prism is one block,
// with a bound of 0. Round outlines are polygons of 32 corners with the area of the circle: within half a percent of
// the radius.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "troupe/world_description.h"
#include "worldfile/gazebo/mesh.h"
#include "worldfile/gazebo/transform3.h"

namespace troupe {

// Lengths in m. The solid's frame is in its middle, but for a prism and a mesh.
struct SolidShape {
  enum class Kind : std::uint8_t { kBox, kCylinder, kCone, kSphere, kCapsule, kEllipsoid, kPrism, kMesh };

  Kind kind = Kind::kBox;
  Vec3 size = {};        // sides of a box, radii of an ellipsoid, scale of a mesh
  double radius = 0.0;   // of a cylinder, cone, sphere or capsule
  double length = 0.0;   // of a cylinder, cone or capsule, without its round ends, along z; of a prism from z 0
  Polygon outline = {};  // of a prism
  std::shared_ptr<const TriangleMesh> mesh = nullptr;
};

enum class SolidUse : std::uint8_t {
  kStatic,  // many exact blocks
  kMoving,  // few blocks: a part of a robot or an object
};

struct SolidBlocks {
  std::vector<Block> blocks;
  double error = 0.0;      // m: no block extends more than this beyond the solid at the height of a section
  bool is_hollow = false;  // of a mesh: a surface without a closed inside is walls only
};

// The blocks of a solid whose frame is at T in the frame of the blocks. Parts without a volume, such as a horizontal
// sheet, have no block.
SolidBlocks BlocksOf(const SolidShape& solid, const Transform3& T, SolidUse use);

// m: the lowest point of the solid.
double LowestPoint(const SolidShape& solid, const Transform3& T);

// The parts of BlocksOf.

// The hulls in bands of the points and edges of triangles. For few points, as it goes over all edges for each band.
SolidBlocks HullsInBands(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                         SolidUse use);

// A mesh that stands still (mesh_blocks.cc): its connected parts that are closed and convex as HullsInBands; what is
// left as rectangles of a grid of 2 cm or more, filled if it is closed.
SolidBlocks MeshBlocks(const TriangleMesh& mesh, SolidUse use);

}  // namespace troupe
