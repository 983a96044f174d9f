// JSON scenarios.
#pragma once

#include <string>

#include "common/worldfile/load_world.h"

namespace troupe {

Result<LoadedWorld> LoadScenario(const std::string& path, const LoadOverrides& overrides = {});

}  // namespace troupe
