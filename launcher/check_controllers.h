// Finds bad controllers before anything is started, so that the message names a line and not a failed process.
#pragma once

#include <string>

#include "common/base/result.h"

namespace troupe {

// Checks the controllers that `file` names, if it is a scenario, and `controller` unless it is empty.
Status CheckControllers(const std::string& file, const std::string& controller);

}  // namespace troupe
