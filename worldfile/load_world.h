// Loading worlds: any file that names a world, to a WorldDescription and the settings of a run.
#pragma once

#include <string>

#include "troupe/result.h"
#include "worldfile/models/loaded_world.h"

namespace troupe {

// Loads a Stage world (.world), a JSON scenario (.json) or a ROS map (.yaml), by the file's ending.
Result<LoadedWorld> LoadWorld(const std::string& path, const LoadOverrides& overrides = {});

// The controllers that a Stage world names, without building it: checks each `ctrl` of a robot by
// `overrides.check_controller`; the error has its place. A file that cannot be read, or is wrong elsewhere, is none
// here.
Status CheckCtrl(const std::string& path, const LoadOverrides& overrides);

}  // namespace troupe
