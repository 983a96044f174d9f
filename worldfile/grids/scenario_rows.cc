#include "worldfile/grids/scenario_rows.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "common/base/source_text.h"
#include "worldfile/grids/grid_lines.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kRowFields = 9;  // bucket map width height start_x start_y goal_x goal_y optimal_length

Result<GridCell> ReadCell(const std::vector<GridWord>& words, std::size_t first, const GridMap& map, const char* what) {
  std::array<std::uint32_t, 2> numbers{};
  for (std::size_t i = 0; i < 2; ++i) {
    const GridWord& word = words[first + i];
    const std::optional<std::uint32_t> number = word.To<std::uint32_t>();
    const std::uint32_t size = i == 0 ? map.width : map.height;
    if (!number || *number >= size) {
      return Error{word.where, fmt::format("found {} for {} of the {}, expected 0 to {}", Quoted(word.text),
                                           i == 0 ? 'x' : 'y', what, size - 1)};
    }
    numbers[i] = *number;
  }
  const GridCell cell{numbers[0], numbers[1]};
  if (map.IsFree(cell)) return cell;
  return Error{words[first].where,
               fmt::format("found the {} at the blocked cell {}, expected a free one", what, ToString(cell))};
}

// As files of benchmarks name it: with a folder that is not there.
std::string FindMap(const std::string& name, const std::string& path) {
  const std::filesystem::path folder = DirectoryOf(path);
  const std::filesystem::path named = (folder / name).lexically_normal();
  std::error_code ignored;
  if (std::filesystem::exists(named, ignored)) return named.string();
  return (folder / std::filesystem::path(name).filename()).lexically_normal().string();
}

}  // namespace

Result<GridProblem> ReadScenarioRows(const std::string& text, const std::string& path,
                                     std::optional<std::uint32_t> agents, const AllowedPaths& allowed) {
  GridProblem problem;
  const std::vector<GridLine> lines = GridLinesOf(text, path);
  const std::vector<GridWord> version = lines.empty() ? std::vector<GridWord>() : lines[0].Words();
  if (version.size() != 2 || version[0].text != "version" || version[1].To<double>() != 1.0) {
    return Error{
        {path, 1, 1},
        fmt::format("found {}, expected 'version 1'", Quoted(lines.empty() ? std::string_view() : lines[0].text))};
  }
  std::string map_name;
  for (std::size_t i = 1; i < lines.size() && (!agents || problem.agents.size() < *agents); ++i) {
    const std::vector<GridWord> words = lines[i].Words();
    if (words.empty()) continue;
    if (words.size() != kRowFields) {
      return Error{lines[i].where,
                   fmt::format("found {}, expected {}: bucket, map, width, height, start x and y, goal x and y, length",
                               CountText(words.size(), "field"), kRowFields)};
    }
    if (map_name.empty()) {
      map_name = words[1].text;
      const std::string file = FindMap(map_name, path);
      Result<GridMap> map = ReadGridMap(file, words[1].where, allowed);
      if (!map.ok()) return map.error();
      problem.map = std::move(map).value();
      problem.files = {path, file};
      for (std::size_t field : {std::size_t{2}, std::size_t{3}}) {
        const std::uint32_t size = field == 2 ? problem.map.width : problem.map.height;
        if (words[field].To<std::uint32_t>() == size) continue;
        problem.warnings.push_back(
            {words[field].where, fmt::format("found a {} of {}, expected {} as of the map",
                                             field == 2 ? "width" : "height", Quoted(words[field].text), size)});
      }
    } else if (words[1].text != map_name) {
      return Error{words[1].where, fmt::format("found the map {}, expected {} as in the first row",
                                               Quoted(words[1].text), Quoted(map_name))};
    }
    GridAgent& agent = problem.agents.emplace_back();
    agent.where = lines[i].where;
    const Result<GridCell> start = ReadCell(words, 4, problem.map, "start");
    if (!start.ok()) return start.error();
    const Result<GridCell> goal = ReadCell(words, 6, problem.map, "goal");
    if (!goal.ok()) return goal.error();
    agent.start = start.value();
    agent.goals = {goal.value()};
  }
  if (problem.agents.empty() && map_name.empty()) {
    return Error{{path, static_cast<int>(lines.size()), 1}, "found no row, expected one for each agent"};
  }
  return problem;
}

}  // namespace troupe
