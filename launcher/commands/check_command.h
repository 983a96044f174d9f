// `troupe check`: loads a world and prints a description of it, without running it.
#pragma once

#include <string>

#include "worldfile/load_world.h"

namespace troupe {

// Several lines, each with its end.
std::string DescribeWorld(const LoadedWorld& loaded);

}  // namespace troupe
