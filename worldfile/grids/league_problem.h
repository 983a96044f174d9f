// Problems of the League of Robot Runners: JSON with `mapFile`, `agentFile` and `taskFile`, paths from its own folder.
//
// `.agents`: a number of agents, then the start of each; `.tasks`: a number of tasks, then the places of each, which
// one agent visits in their order. A place is row * width + column; lines that begin with '#' are comments.
//
// In the League a scheduler gives tasks to agents during the run. Here they are given out before it, in their order:
// each task to the agent that is free first, if cells are a step, of several to the nearest one. Each agent so has a
// list of goals.
//
// `delayConfig` becomes delays before moves, with pDelay for each tick of a move, and minDelay to maxDelay of its
// ticks; `agentCounter` ticks are a cell. Its generators are not those of the League, so that the delays are others.
#pragma once

#include <optional>
#include <string>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/grids/grid_problem.h"

namespace troupe {

// True if a file ends in .json and is an object with the key `mapFile`.
bool IsLeaguePath(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

Result<GridProblem> ReadLeagueProblem(const std::string& text, const std::string& path,
                                      std::optional<std::uint32_t> agents, const AllowedPaths& allowed);

}  // namespace troupe
