// Drawn blocks as the body of a model. Private to this folder.
#pragma once

#include <limits>
#include <vector>

#include "viewer/editor/request_values.h"
#include "worldfile/edit/written_model.h"

namespace troupe {

// The box around drawn blocks, in their unit.
struct BlockBounds {
  double min_x = std::numeric_limits<double>::max();
  double min_y = std::numeric_limits<double>::max();
  double min_z = std::numeric_limits<double>::max();
  double max_x = std::numeric_limits<double>::lowest();
  double max_y = std::numeric_limits<double>::lowest();
  double max_z = std::numeric_limits<double>::lowest();
};
BlockBounds BoundsOf(const std::vector<DrawnBlock>& blocks);

// Blocks are fitted to the model's size and centred on its origin: with the size of their own box, and the origin at
// the middle of it, they are where they were drawn.
struct FittedBody {
  WrittenValue size;
  WrittenValue origin;
  bool is_centred = false;  // the origin is [0 0 0 0]
  std::vector<WrittenModel> blocks;
};
// REQUIRES: there is a block. In the file's unit of length.
FittedBody Fitted(const std::vector<DrawnBlock>& blocks);

// True for a single upright box that stands on the ground: it needs no blocks but its size.
bool IsBox(const std::vector<DrawnBlock>& blocks);

}  // namespace troupe
