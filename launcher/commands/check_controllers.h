// CheckControllers: finds bad controllers before any process is started, so that the error has a line of the scenario.
#pragma once

#include <string>

#include "common/base/result.h"

namespace troupe {

// Checks the controllers that `file` names, if it is a scenario, and `controller` unless it is empty.
Status CheckControllers(const std::string& file, const std::string& controller);

}  // namespace troupe
