// Problems of multi-agent paths on a map of cells: agents with starts and goals, and perhaps their paths.
//
// Files: movingai's `.scen` (an agent each row), a `.map` alone (no agents), a POGEMA string (an agent each letter),
// and the problems of the League of Robot Runners (`.json` with `mapFile`). Paths come from a second file
// (path_text.h).
//
// A problem that is read can be solved as far as a look at each agent tells: starts are free and apart, and each goal
// can be reached from the start; goals of agents that have only one are apart, too. Paths, if there are any, are those
// of all agents, begin at their starts, go from cell to cell, and meet nowhere; without tasks they end at the goals.
// Otherwise there is an error with line and column.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/grids/grid_map.h"

namespace troupe {

// Delays of robots: before each move, with this probability, for s between these bounds.
struct MoveDelays {
  double probability = 0.0;
  double min_seconds = 1.0;
  double max_seconds = 5.0;
  bool operator==(const MoveDelays&) const = default;
};

// "0.1", or "0.1,1,5".
Result<MoveDelays> ParseMoveDelays(const std::string& text);
std::string ToString(const MoveDelays& delays);

// What a user asks of a file with cells.
struct GridOptions {
  std::optional<std::uint32_t> agents = {};  // the first ones of the file; nothing: all
  std::optional<double> cell = {};           // m, the side of a cell; nothing: kDefaultCell
  std::string paths = {};  // a file with a path for each robot; empty: the planned traffic finds the ways
  std::optional<MoveDelays> delays = {};
  bool operator==(const GridOptions&) const = default;
};

inline constexpr double kDefaultCell = 1.0;  // m
inline constexpr double kMinCell = 0.5;      // m
inline constexpr double kMaxCell = 100.0;    // m
inline constexpr std::uint32_t kMaxAgents = 100'000;

struct GridAgent {
  std::string name;
  GridCell start;
  std::vector<GridCell> goals;       // in their order, each another one than before
  std::vector<GridCell> path;        // from the start on; empty: none
  std::vector<std::uint32_t> steps;  // of each cell of the path; ascending from 0
  SourceLocation where;              // of its row
};

// Places that one agent visits in their order.
struct GridTask {
  std::size_t agent = 0;
  std::vector<GridCell> places;
  std::vector<std::size_t> goals;  // by place, among the goals of the agent
};

struct GridProblem {
  GridMap map;
  double cell = kDefaultCell;  // m
  std::vector<GridAgent> agents;
  bool has_tasks = false;       // several goals an agent, one after another
  std::vector<GridTask> tasks;  // in the order of the file
  std::optional<MoveDelays> delays;
  std::vector<std::string> files;
  std::vector<Warning> warnings;
};

// True if it is a file with cells: `.map`, `.pogema`, `.scen`, or a problem of the League.
bool IsGridPath(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

Result<GridProblem> ReadGridProblem(const std::string& path, const GridOptions& options,
                                    const AllowedPaths& allowed = AllowedPaths::All());

// The cells with a side in common with a cell, that are free: east, north, west, south.
std::vector<GridCell> FreeNeighbours(const GridMap& map, const GridCell& cell);

// The problem as JSON, for planners: "width", "height", "map" (a string each row, '.' and '@'), "agents" with "name",
// "start" and "goals" as [x, y].
std::string ProblemJson(const GridProblem& problem);

}  // namespace troupe
