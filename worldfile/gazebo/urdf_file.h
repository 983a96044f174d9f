// URDF robots (.urdf): to a RigidModel, with the sensors and plugins of its `gazebo` elements. Frame M is the root
// link.
#pragma once

#include <optional>
#include <string>

#include "troupe/result.h"
#include "worldfile/gazebo/model_files.h"
#include "worldfile/gazebo/rigid_model.h"

namespace troupe {

// The robot of a `robot` element; nothing after an error of the diagnostics.
std::optional<RigidModel> ReadUrdf(const XmlElement& robot, const std::string& path, ModelFiles& files,
                                   Diagnostics& diagnostics);

// The URDF that the program `xacro` makes of a file; nothing if it is not installed. The error is a program that fails.
Result<std::optional<std::string>> RunXacro(const std::string& path);

}  // namespace troupe
