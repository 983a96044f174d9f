// Controllers by name: "idle", "wander", "expand", "script", or the path of a shared library (it contains a slash or
// ends in ".so").
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "robot-agent/controller/controller.h"

namespace troupe {

// Names of the built-in controllers, sorted.
std::vector<std::string> BuiltInControllers();

// The error names the controller and what is wrong with its name, its parameters or its library.
Result<std::unique_ptr<Controller>> CreateController(const RobotInfo& info);

// Checks name and parameters without making one; a library is not opened. "" if they are good. For loaders.
std::string CheckController(const std::string& name, const std::string& parameters);

}  // namespace troupe
