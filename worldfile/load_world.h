// Loading worlds: any file that names a world, to a WorldDescription and the settings of a run.
#pragma once

#include <string>

#include "troupe/result.h"
#include "worldfile/models/loaded_world.h"

namespace troupe {

// Loads a Stage world (.world), a JSON scenario (.json) or a ROS map (.yaml), by the file's ending.
Result<LoadedWorld> LoadWorld(const std::string& path, const LoadOverrides& overrides = {});

}  // namespace troupe
