// The parts of a define of the edited file: the entries of its body but for blocks, each with the model that the loader
// makes of it. Frames: D the define's, N a part's, P its parent's. Private to this folder.
//
// A define is built alone, in a world of its own, so that a part can be shown and measured although the file has no
// model of it. A part is found by its path of indices and not by name, because parts need no names.
//
// Numbers are written back in the file's units, and one that has not changed keeps its digits: an edit of x must not
// turn a hand-written 0.1 into 0.1000.
#pragma once

#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/pose.h"
#include "troupe/result.h"
#include "viewer/editor/editable_world.h"
#include "viewer/gateway/edit_operation.h"
#include "worldfile/edit/written_model.h"
#include "worldfile/stage/stage_tree.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// A define built alone: the first model of the world is its root, at the origin.
struct BuiltDefine {
  WorldNode node;
  WorldDescription world;
  FileUnits units;
};
Result<BuiltDefine> BuildDefine(const WorldTree& tree, const std::string& name, const NamedFiles& files);

// `statement` and `node` are two views of one entry: its bytes in the text, and its properties with those that macros
// and types give.
struct ModelPart {
  PartPath path;
  const Statement* statement = nullptr;
  const WorldNode* node = nullptr;
  std::string name;              // full, in the built world
  std::optional<ModelId> model;  // nothing: a sensor
  std::vector<ModelPart> parts;
};

// `define`: the statement of the define, in `text`, which `path` names.
std::vector<ModelPart> PartsOf(const BuiltDefine& built, const Statement& define, const std::string& path);

// Null: there is none. An empty path has none.
const ModelPart* FindPart(const std::vector<ModelPart>& parts, const PartPath& path);

// The place of a part: that of its parent, and the height that the parent's stacking adds to its pose.
struct PartPlace {
  Pose X_DP;
  double stack = 0.0;  // m
};
// `path`: of the parent; empty: the define's root.
PartPlace PlaceBelow(const BuiltDefine& built, const std::vector<ModelPart>& parts, const PartPath& path);

// {"index", "type", "line", "properties": {...}, "parts": [...]}; of a model also, in m and rad and in frame D,
// {"model": base type, "name", "pose", "body": pose of the body's middle, "size", "is_box", "bodies": picture blocks,
//  "joint": {"type", "axis", "limits", "max_speed"}, "gripper": {"paddle": size, or of its own parts
//  "left_finger": path ...}}
nlohmann::json PartsReport(const BuiltDefine& built, const std::vector<ModelPart>& parts, const std::string& text);

// Picture blocks of the models that belong to no listed part, without the define's root.
nlohmann::json BodiesOfOthers(const BuiltDefine& built, const std::vector<ModelPart>& parts);

// Values of the edited file: numbers in its units, each in its old form where it has not changed, and drawn blocks as
// bodies.

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
