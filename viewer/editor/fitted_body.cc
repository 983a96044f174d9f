#include "viewer/editor/fitted_body.h"

#include <algorithm>
#include <cmath>

namespace troupe {

BlockBounds BoundsOf(const std::vector<DrawnBlock>& blocks) {
  BlockBounds bounds;
  for (const DrawnBlock& block : blocks) {
    for (const Vec2& corner : block.outline) {
      bounds.min_x = std::min(bounds.min_x, corner.x());
      bounds.max_x = std::max(bounds.max_x, corner.x());
      bounds.min_y = std::min(bounds.min_y, corner.y());
      bounds.max_y = std::max(bounds.max_y, corner.y());
    }
    bounds.min_z = std::min(bounds.min_z, block.z_min);
    bounds.max_z = std::max(bounds.max_z, block.z_max);
  }
  return bounds;
}

FittedBody Fitted(const std::vector<DrawnBlock>& blocks) {
  const BlockBounds bounds = BoundsOf(blocks);
  const double x = 0.5 * (bounds.min_x + bounds.max_x);
  const double y = 0.5 * (bounds.min_y + bounds.max_y);
  FittedBody body{Tuple({bounds.max_x - bounds.min_x, bounds.max_y - bounds.min_y, bounds.max_z - bounds.min_z}),
                  Tuple({x, y, 0.0, 0.0}, 5),
                  std::abs(x) < 1e-5 && std::abs(y) < 1e-5,
                  {}};
  for (const DrawnBlock& block : blocks) {
    body.blocks.push_back(WrittenBlock(block.outline, block.z_min, block.z_max));
  }
  return body;
}

bool IsBox(const std::vector<DrawnBlock>& blocks) {
  if (blocks.size() != 1 || blocks[0].outline.size() != 4 || blocks[0].z_min != 0.0) return false;
  const BlockBounds bounds = BoundsOf(blocks);
  return std::all_of(blocks[0].outline.begin(), blocks[0].outline.end(), [&](const Vec2& corner) {
    return (corner.x() == bounds.min_x || corner.x() == bounds.max_x) &&
           (corner.y() == bounds.min_y || corner.y() == bounds.max_y);
  });
}

}  // namespace troupe
