// The rows of movingai's scenarios (`.scen`, version 1), with their map.
#pragma once

#include <string>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/grids/grid_problem.h"

namespace troupe {

// The map and the first agents. The map is looked for at its name from the folder of the file, then beside the file.
Result<GridProblem> ReadScenarioRows(const std::string& text, const std::string& path,
                                     std::optional<std::uint32_t> agents, const AllowedPaths& allowed);

}  // namespace troupe
