#include "worldfile/grids/grid_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "common/base/source_text.h"
#include "worldfile/grids/grid_lines.h"
#include "worldfile/grids/league_problem.h"
#include "worldfile/grids/path_text.h"
#include "worldfile/grids/scenario_rows.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

Result<GridProblem> ProblemOfMap(const std::string& path, const AllowedPaths& allowed) {
  Result<GridMap> map = ReadGridMap(path, {path}, allowed);
  if (!map.ok()) return map.error();
  GridProblem problem;
  problem.map = std::move(map).value();
  problem.files = {path};
  for (const auto& [letter, mark] : problem.map.marks) {
    problem.agents.push_back({.name = std::string(1, letter),
                              .start = *mark.start,
                              .goals = {*mark.target},
                              .path = {},
                              .steps = {},
                              .where = {path}});
  }
  return problem;
}

Result<GridProblem> ReadByEnding(const std::string& path, const GridOptions& options, const AllowedPaths& allowed) {
  if (IsGridMapPath(path)) return ProblemOfMap(path, allowed);
  const Result<std::string> text = ReadTextFile(path, {path}, allowed);
  if (!text.ok()) return text.error();
  return path.ends_with(".scen") ? ReadScenarioRows(text.value(), path, options.agents, allowed)
                                 : ReadLeagueProblem(text.value(), path, options.agents, allowed);
}

// By cell, the number of the part of the map that it is in; cells of one part reach each other.
std::vector<std::uint32_t> PartsOf(const GridMap& map) {
  std::vector<std::uint32_t> parts(map.blocked.size(), 0);
  std::uint32_t count = 0;
  std::vector<GridCell> open;
  for (std::uint32_t y = 0; y < map.height; ++y) {
    for (std::uint32_t x = 0; x < map.width; ++x) {
      if (!map.IsFree({x, y}) || parts[map.IndexOf({x, y})] != 0) continue;
      open = {{x, y}};
      parts[map.IndexOf({x, y})] = ++count;
      while (!open.empty()) {
        const GridCell cell = open.back();
        open.pop_back();
        for (const GridCell& next : FreeNeighbours(map, cell)) {
          if (std::exchange(parts[map.IndexOf(next)], count) == 0) open.push_back(next);
        }
      }
    }
  }
  return parts;
}

Status CheckAgents(const GridProblem& problem) {
  const std::vector<std::uint32_t> parts = problem.agents.empty() ? std::vector<std::uint32_t>() : PartsOf(problem.map);
  std::map<GridCell, std::size_t> starts;
  std::map<GridCell, std::size_t> ends;
  for (std::size_t i = 0; i < problem.agents.size(); ++i) {
    const GridAgent& agent = problem.agents[i];
    const auto [start, is_new] = starts.emplace(agent.start, i);
    if (!is_new) {
      return Error{agent.where, fmt::format("found the start {} of agent {} again, expected another one",
                                            ToString(agent.start), start->second)};
    }
    const std::uint32_t part = parts[problem.map.IndexOf(agent.start)];
    for (const GridCell& goal : agent.goals) {
      if (parts[problem.map.IndexOf(goal)] == part) continue;
      return Error{agent.where, fmt::format("found the goal {}, expected one that can be reached from the start {}",
                                            ToString(goal), ToString(agent.start))};
    }
    if (problem.has_tasks || agent.goals.empty()) continue;
    const auto [end, is_other] = ends.emplace(agent.goals.back(), i);
    if (!is_other) {
      return Error{agent.where, fmt::format("found the goal {} of agent {} again, expected another one",
                                            ToString(agent.goals.back()), end->second)};
    }
  }
  return Status();
}

}  // namespace

Result<MoveDelays> ParseMoveDelays(const std::string& text) {
  MoveDelays delays;
  const auto fail = [&] {
    return BadInput(
        fmt::format("found {}, expected a probability, or 'PROBABILITY,MIN,MAX' with s from MIN to MAX", Quoted(text)));
  };
  std::vector<double> numbers;
  std::string_view rest = text;
  while (true) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::optional<double> number = GridWord{rest.substr(0, comma), {}}.To<double>();
    if (!number || !(*number >= 0.0 && *number <= 1e6)) return fail();
    numbers.push_back(*number);
    if (comma == rest.size()) break;
    rest.remove_prefix(comma + 1);
  }
  if ((numbers.size() != 1 && numbers.size() != 3) || numbers[0] > 1.0) return fail();
  delays.probability = numbers[0];
  if (numbers.size() == 1) return delays;
  if (numbers[1] > numbers[2]) return fail();
  delays.min_seconds = numbers[1];
  delays.max_seconds = numbers[2];
  return delays;
}

std::string ToString(const MoveDelays& delays) {
  return fmt::format("{},{},{}", delays.probability, delays.min_seconds, delays.max_seconds);
}

bool IsGridPath(const std::string& path, const AllowedPaths& allowed) {
  return IsGridMapPath(path) || path.ends_with(".scen") || IsLeaguePath(path, allowed);
}

std::vector<GridCell> FreeNeighbours(const GridMap& map, const GridCell& cell) {
  std::vector<GridCell> found;
  const auto add = [&](int dx, int dy) {
    const std::int64_t x = std::int64_t{cell.x} + dx;
    const std::int64_t y = std::int64_t{cell.y} + dy;
    if (!map.Contains(x, y)) return;
    const GridCell next{static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)};
    if (map.IsFree(next)) found.push_back(next);
  };
  add(1, 0);
  add(0, -1);
  add(-1, 0);
  add(0, 1);
  return found;
}

Result<GridProblem> ReadGridProblem(const std::string& path, const GridOptions& options, const AllowedPaths& allowed) {
  Result<GridProblem> read = ReadByEnding(path, options, allowed);
  if (!read.ok()) return read;
  GridProblem& problem = read.value();
  problem.cell = options.cell.value_or(kDefaultCell);
  if (!(problem.cell >= kMinCell && problem.cell <= kMaxCell)) {
    return Error{
        {}, fmt::format("option --cell: found {}, expected {} to {} m", NumberText(problem.cell), kMinCell, kMaxCell)};
  }
  if (options.delays) problem.delays = options.delays;
  if (options.agents && problem.agents.size() < *options.agents) {
    return Error{{path},
                 fmt::format("found {}, expected {} for option --agents", CountText(problem.agents.size(), "agent"),
                             *options.agents)};
  }
  if (options.agents) problem.agents.resize(*options.agents);
  if (problem.agents.size() > kMaxAgents) {
    return Error{{path}, fmt::format("found {} agents, expected at most {}", problem.agents.size(), kMaxAgents)};
  }
  for (std::size_t i = 0; i < problem.agents.size(); ++i) {
    if (problem.agents[i].name.empty()) problem.agents[i].name = "r" + std::to_string(i);
  }
  if (Status status = CheckAgents(problem); !status.ok()) return status.error();
  if (options.paths.empty()) return read;
  const Result<std::string> text = ReadTextFile(options.paths, {options.paths}, allowed);
  if (!text.ok()) return text.error();
  if (Status status = ReadPaths(text.value(), options.paths, problem); !status.ok()) return status.error();
  problem.files.push_back(options.paths);
  return read;
}

std::string ProblemJson(const GridProblem& problem) {
  const auto to_json = [](const GridCell& cell) { return nlohmann::ordered_json::array({cell.x, cell.y}); };
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (std::uint32_t y = 0; y < problem.map.height; ++y) {
    std::string row;
    for (std::uint32_t x = 0; x < problem.map.width; ++x) row += problem.map.IsFree({x, y}) ? '.' : '@';
    rows.push_back(std::move(row));
  }
  nlohmann::ordered_json agents = nlohmann::ordered_json::array();
  for (const GridAgent& agent : problem.agents) {
    nlohmann::ordered_json goals = nlohmann::ordered_json::array();
    for (const GridCell& goal : agent.goals) goals.push_back(to_json(goal));
    agents.push_back({{"name", agent.name}, {"start", to_json(agent.start)}, {"goals", std::move(goals)}});
  }
  const nlohmann::ordered_json json = {{"width", problem.map.width},
                                       {"height", problem.map.height},
                                       {"map", std::move(rows)},
                                       {"agents", std::move(agents)}};
  return json.dump();
}

}  // namespace troupe
