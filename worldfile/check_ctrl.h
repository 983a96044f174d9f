// CheckCtrl: the controllers that a Stage world names, without building its world.
#pragma once

#include <string>

#include "troupe/result.h"
#include "worldfile/models/loaded_world.h"

namespace troupe {

// Checks each `ctrl` of a robot by `overrides.check_controller`; the error has its place. A file that cannot be read,
// or is wrong elsewhere, is none here.
Status CheckCtrl(const std::string& path, const LoadOverrides& overrides);

}  // namespace troupe
