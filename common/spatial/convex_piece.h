// ConvexPiece: the unit of all geometric tests, a convex prism with the properties of the model that it belongs to.
#pragma once

#include <span>
#include <vector>

#include "troupe/ids.h"
#include "troupe/polygon.h"
#include "troupe/pose.h"
#include "troupe/world_description.h"
#include "troupe/z_range.h"

namespace troupe {

struct ConvexPiece {
  std::vector<Vec2> vertices;  // m, counter-clockwise; frame: W for static pieces, the link's L for a body's
  ZRange z;                    // m, in the same frame
  ModelId model;
  bool obstacle = true;
  double ranger_return = 1.0;  // negative: transparent
};

// False for a height interval that nothing collides with and no ray hits.
bool HasHeight(const ZRange& z);

// True for the vertices of a rectangle along the axes.
bool IsBox(std::span<const Vec2> vertices);

// The pieces of a model's shape, moved by X_FM into frame F, without those of its area (pixel_pieces.h).
std::vector<ConvexPiece> MakePieces(const WorldDescription& world, ModelId model, const Pose& X_FM);

// `piece` moved by X_WF.
ConvexPiece Transformed(const ConvexPiece& piece, const Pose& X_WF);

}  // namespace troupe
