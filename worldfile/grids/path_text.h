// Files with the paths of the agents of a problem, by planners.
//
// Two forms, told apart by the first character that is not blank:
//
// - text, as SMART and many planners write it: a line `Agent N: (a,b,t)->(a,b,t)->...` each agent, with or without t;
//   lines of further agents do not count.
//   Cells are (x, y) or (row, column): the first of both that has all agents at their starts. t is the step; without it
//   cells are a step apart. A cell that is repeated is a wait.
// - JSON `{...}` of the League of Robot Runners: the member `actualPaths`, a string each agent. In the form since 2026
//   `[(t,row,column,orientation,counter):(FW n,CR n,...)]...`, with `agentMaxCounter` ticks of FW a cell; before that
//   `F,R,C,W,...` with the states of the member `start`.
#pragma once

#include <string>

#include "troupe/result.h"
#include "worldfile/grids/grid_problem.h"

namespace troupe {

// Reads the paths into the agents. The error has line and column in the file.
Status ReadPaths(const std::string& text, const std::string& path, GridProblem& problem);

}  // namespace troupe
