// The options of a problem of paths on a map of cells, for the programs and commands that load one.
#pragma once

#include <string>
#include <vector>

#include "worldfile/grids/grid_problem.h"

namespace CLI {
class App;
}

namespace troupe {

// --agents, --cell, --paths and --delays. `options` must outlive the parsing.
void AddGridFlags(CLI::App& app, GridOptions& options, const std::string& group = "Options");

// The arguments that give another program the same options.
std::vector<std::string> GridArguments(const GridOptions& options);

}  // namespace troupe
