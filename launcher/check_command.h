// `troupe check`: loads a world and says what it holds.
#pragma once

#include <string>

#include "common/worldfile/load_world.h"

namespace troupe {

// Several lines, each ended.
std::string DescribeWorld(const LoadedWorld& loaded);

// Returns the exit status.
int CheckCommand(const std::string& file);

}  // namespace troupe
