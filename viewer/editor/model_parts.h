// The parts of a define of the edited file: the entries of its body but for blocks, each with the model that the loader
// makes of it. Frames: D the define's, N a part's, P its parent's. Private to this folder.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/result.h"
#include "viewer/editor/editable_world.h"
#include "viewer/gateway/edit_operation.h"
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

}  // namespace troupe
