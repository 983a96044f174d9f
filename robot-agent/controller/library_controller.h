// Controllers from shared libraries.
#pragma once

#include <memory>
#include <string>

#include "common/base/allowed_paths.h"
#include "troupe/controller.h"
#include "troupe/result.h"

namespace troupe {

// Opens the library (a relative path starts at the working directory), if `allowed` allows it, and calls its factory of
// a controller. The library stays open until the program ends, because exceptions and objects of its types may live as
// long.
Result<std::unique_ptr<Controller>> CreateLibraryController(const std::string& path, const RobotInfo& info,
                                                            const AllowedPaths& allowed);

}  // namespace troupe
