// Values of the edited file: numbers in its units, each in its old form where it has not changed, and drawn blocks as
// bodies. Private to this folder.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "troupe/pose.h"
#include "viewer/editor/editable_world.h"
#include "viewer/gateway/edit_operation.h"
#include "worldfile/edit/written_model.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

inline constexpr int kLengthDecimals = 4;   // a tenth of a millimetre in metres
inline constexpr int kHeadingDecimals = 2;  // of degrees
inline constexpr int kRadianDecimals = 5;

// To (-180, 180].
double WrappedDegrees(double degrees);

// The numbers of a property of the node, as in the file; 0 for a text. Empty: it has no such tuple.
std::vector<Value::Number> NumbersOf(const WorldNode& node, const std::string& name);

// The property `origin` in m and rad: the pose of the body in the model's frame.
Pose OriginOf(const WorldNode& node, const FileUnits& units);

// A tuple of numbers that replaces `old`, which may have fewer.
Value ChangedTuple(const std::vector<Value::Number>& old, const std::vector<double>& numbers,
                   int decimals = kLengthDecimals);

// A pose that replaces `old`. `pose`: in m and rad, in the frame of the property.
Value ChangedPose(std::vector<Value::Number> old, const Pose& pose, const FileUnits& units);

// An angle in rad in the file's unit, without wrapping, and its decimals there.
double AngleInFile(double angle, const FileUnits& units);
int AngleDecimals(const FileUnits& units);

// Drawn blocks in the frame F of a pose, and in the file's unit of length.
std::vector<DrawnBlock> BlocksInFrame(std::vector<DrawnBlock> blocks, const Pose& X_DF, double metres);

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
  Value size;
  Value origin;
  bool is_centred = false;  // the origin is [0 0 0 0]
  std::vector<WrittenModel> blocks;
};
// REQUIRES: there is a block. In the file's unit of length.
FittedBody Fitted(const std::vector<DrawnBlock>& blocks);

// True for a single upright box that stands on the ground: it needs no blocks but its size.
bool IsBox(const std::vector<DrawnBlock>& blocks);

}  // namespace troupe
