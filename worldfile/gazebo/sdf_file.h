// SDF worlds and models (.sdf, and .world of Gazebo): to RigidModels, with includes, nested models and frames resolved.
//
// Read: versions 1.3 to 1.12 of the format (sdformat.org). Poses are relative to what `relative_to` (or `frame` of old
// versions) names: links, joints, frames, nested models ("arm::hand") and, in a world, its models and frames; a model's
// `placement_frame` and a classic `state` count. Nested models become parts of the model around them, with the names of
// their links behind "NAME::". What is not read is named in a warning, once for each kind.
#pragma once

#include <string>
#include <vector>

#include "troupe/result.h"
#include "worldfile/gazebo/model_files.h"
#include "worldfile/gazebo/rigid_model.h"

namespace troupe {

struct SdfWorld {
  std::string name;
  std::optional<double> gravity;   // m/s^2
  std::vector<RigidModel> models;  // T_PM is in W
  bool is_world = false;           // the file has a `world`, not a lone model
};

// Whether the text is XML with an `sdf` or `gazebo` element at its root: it tells Gazebo's .world from Stage's.
bool IsSdfText(std::string_view text);

// Reads a file. Lone models of it are those of a world without a name.
Result<SdfWorld> ReadSdf(const std::string& path, ModelFiles& files, Diagnostics& diagnostics);

// The solid of a `geometry`; nothing for one that has no solid, with a warning if it matters, or after an error. Also
// of URDF, whose geometries have attributes in place of elements.
std::vector<SolidShape> ReadGeometry(const XmlElement& geometry, const std::string& file, ModelFiles& files,
                                     Diagnostics& diagnostics);

}  // namespace troupe
