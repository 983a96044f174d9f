#include "worldfile/grids/grid_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "troupe/deterministic_math.h"
#include "worldfile/sites/node_maker.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr double kRadius = 0.175;            // of a cell
constexpr double kMargin = 0.205;            // m, to the middle between two lanes, as the planned traffic keeps it
constexpr double kGap = 0.05;                // m, to the robot ahead
constexpr double kHeight = 0.3;              // m
constexpr int kCorners = 16;                 // of the disc
constexpr double kSpeed = 1.0;               // m/s
constexpr double kAcceleration = 2.0;        // m/s^2
constexpr double kTurnRate = 180.0;          // degrees/s
constexpr double kTurnAcceleration = 720.0;  // degrees/s^2
constexpr double kTurnRateOfWay = 3.0;       // rad/s, of the controller

std::vector<double> Symmetric(double x, double heading) {
  return {-x, x, 0.0, 0.0, 0.0, 0.0, -heading, heading};
}

Define CellRobot(double cell, const SourceLocation& where) {
  const double width = 2.0 * RadiusOfCellRobot(cell);
  NodeMaker disc("block", where);
  disc.Number("points", kCorners);
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * kPi * i / kCorners;
    const SinCosResult direction = SinCos(angle);
    disc.Numbers("point[" + std::to_string(i) + "]", {0.5 * width * direction.cos, 0.5 * width * direction.sin});
  }
  disc.Numbers("z", {0.0, kHeight});
  NodeMaker robot("position", where);
  robot.Text("drive", "diff").Text("color", "SteelBlue").Number("gui_nose", 1);
  robot.Numbers("size", {width, width, kHeight}).Child(std::move(disc.node));
  robot.Numbers("velocity_bounds", Symmetric(kSpeed, kTurnRate));
  robot.Numbers("acceleration_bounds", Symmetric(kAcceleration, kTurnAcceleration));
  return {robot.node.type, robot.node.properties, robot.node.children, where};
}

// With a path the robot follows it; else it goes to its goals, and back to the last one when it has made room.
std::string ControllerOf(const GridProblem& problem, const GridAgent& agent) {
  std::string text =
      fmt::format("lanes planned=true repeat=false wait=0 keep_place=true turn_rate={} gap={}", kTurnRateOfWay, kGap);
  if (problem.delays) {
    text += fmt::format(" delay_probability={} delay_min={} delay_max={}", problem.delays->probability,
                        problem.delays->min_seconds, problem.delays->max_seconds);
  }
  if (!agent.path.empty() || agent.goals.empty()) return text;
  text += " places=[";
  for (std::size_t i = 0; i < agent.goals.size(); ++i) {
    text += fmt::format("{}\"{}\"", i > 0 ? "," : "", VertexName(agent.goals[i]));
  }
  return text + "]";
}

}  // namespace

double RadiusOfCellRobot(double cell) {
  return std::min(kRadius * cell, 0.5 * cell - kMargin);
}

std::string VertexName(const GridCell& cell) {
  return fmt::format("x{}y{}", cell.x, cell.y);
}

Result<WorldTree> GridTree(std::shared_ptr<const GridProblem> problem) {
  const std::string& file = problem->files.front();
  WorldTree tree;
  tree.world.type = "world";
  tree.world.where = {file, 1, 1};
  tree.directory = DirectoryOf(problem->map.file);
  tree.files = problem->files;
  tree.warnings = problem->warnings;
  tree.defines.emplace("CellRobot", CellRobot(problem->cell, tree.world.where));
  NodeMaker map("model", {problem->map.file});
  map.Text("name", "map").Text("map_cells", std::filesystem::path(problem->map.file).filename().string());
  tree.world.children.Add(std::move(map.Number("cell_size", problem->cell).Text("color", "gray30").node));
  for (const GridAgent& agent : problem->agents) {
    Result<WorldNode> robot = Instantiate(tree, "CellRobot", agent.where);
    if (!robot.ok()) return robot.error();
    NodeMaker maker("position", agent.where);
    maker.node = std::move(robot).value();
    const Vec2 position = problem->map.CenterOf(agent.start, problem->cell);
    maker.Text("name", agent.name).At({position.x(), position.y(), 0.0, 0.0});
    maker.Text("ctrl", ControllerOf(*problem, agent));
    tree.world.children.Add(std::move(maker.node));
  }
  tree.grid = std::move(problem);
  return tree;
}

Result<WorldTree> ReadGridTree(const std::string& path, const GridOptions& options, const AllowedPaths& allowed) {
  Result<GridProblem> problem = ReadGridProblem(path, options, allowed);
  if (!problem.ok()) return problem.error();
  return GridTree(std::make_shared<const GridProblem>(std::move(problem).value()));
}

}  // namespace troupe
