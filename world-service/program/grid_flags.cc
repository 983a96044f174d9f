#include "world-service/program/grid_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "command_line/parse_command_line.h"

namespace troupe {
namespace {

std::string CheckDelays(const std::string& text) {
  const Result<MoveDelays> delays = ParseMoveDelays(text);
  return delays.ok() ? "" : delays.error().message;
}

}  // namespace

void AddGridFlags(CLI::App& app, GridOptions& options, const std::string& group) {
  app.add_option("--agents", options.agents, "With a problem of paths: its first N agents (default: all)")
      ->check(WholeNumber(1, kMaxAgents))
      ->type_name("N")
      ->group(group);
  app.add_option("--cell", options.cell,
                 fmt::format("With a map of cells: the side of a cell, m (default: {:g})", kDefaultCell))
      ->check(PositiveNumber())
      ->type_name("M")
      ->group(group);
  app.add_option("--paths", options.paths,
                 "With a problem of paths: a file with the path of each agent, which the robots follow (default: the "
                 "planned traffic finds the ways)")
      ->check(NotEmpty())
      ->type_name("FILE")
      ->group(group);
  app.add_option_function<std::string>(
         "--delays",
         [&options](const std::string& text) {
           if (const Result<MoveDelays> delays = ParseMoveDelays(text); delays.ok()) options.delays = delays.value();
         },
         "With a problem of paths: the probability with which a robot stands for a while before it enters a cell, and "
         "between how many seconds (default: the file's, or none; 1,5)")
      ->check(CLI::Validator(CheckDelays, ""))
      ->type_name("P[,MIN,MAX]")
      ->allow_extra_args(false)
      ->group(group);
}

std::vector<std::string> GridArguments(const GridOptions& options) {
  std::vector<std::string> arguments;
  if (options.agents) arguments.push_back(fmt::format("--agents={}", *options.agents));
  if (options.cell) arguments.push_back(fmt::format("--cell={}", *options.cell));
  if (!options.paths.empty()) arguments.push_back("--paths=" + options.paths);
  if (options.delays) arguments.push_back("--delays=" + ToString(*options.delays));
  return arguments;
}

}  // namespace troupe
