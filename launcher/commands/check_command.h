// `troupe check`: loads a world and prints a description of it, without running it.
#pragma once

#include <string>

#include "worldfile/load_world.h"

namespace CLI {
class App;
}

namespace troupe {

// Several lines, each with its end.
std::string DescribeWorld(const LoadedWorld& loaded);

// Adds the command; running it sets `exit_status`.
void AddCheckCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
