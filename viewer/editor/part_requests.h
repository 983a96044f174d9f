// The values of a request that concerns a part of a model, checked. Private to this folder.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/pose.h"
#include "troupe/result.h"
#include "viewer/editor/model_parts.h"
#include "viewer/editor/request_values.h"

namespace troupe {

// A list of indices; a request without one means the define itself. Up to 20.
Result<PartPath> PartPathIn(const nlohmann::json& request, const char* key);

// The members of "shape" that are given, in m and rad, and in the frame D of the define.
struct PartShape {
  std::optional<Pose> pose;                   // "pose": [x, y, z, heading]
  std::optional<std::vector<double>> size;    // "size": [x, y, z] of the body
  std::optional<std::vector<double>> paddle;  // "paddle": length, thickness and height of a gripper's own paddles
  std::optional<std::vector<double>> axis;    // "axis": [x, y, z] of a linear joint, of any length but 0
  std::optional<std::vector<double>> limits;  // "limits": [min, max] of a joint
  std::vector<DrawnBlock> blocks;             // "blocks"; empty: none given
};
// The error names a member that has another form. An empty shape is one, too, unless `may_be_empty`.
Result<PartShape> PartShapeIn(const nlohmann::json& request, bool may_be_empty);

// "roles": {"left_finger": path of a part, or null: none, ...}, by the names of a gripper's properties.
using GripperRoles = std::vector<std::pair<std::string, std::optional<PartPath>>>;
Result<GripperRoles> GripperRolesIn(const nlohmann::json& request);

}  // namespace troupe
