// From a problem of paths to the models of a world: the map as one static model, "map", and a robot for each agent.
//
// The tree has the define `CellRobot`, a disc that drives from cell to cell. It is so small that two of them pass each
// other on lanes that are a cell apart, and that four can go round in a circle of four cells, one after another, each
// by the distance that `lanes` keeps to the circle around the box of the robot ahead. Robots have the controller
// `lanes`, which takes part in the planned traffic; the lanes themselves follow from the problem that the tree refers
// to (worldfile/models/grid_lanes.h).
#pragma once

#include <memory>
#include <string>

#include "worldfile/grids/grid_problem.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// m, of the robot for cells of that side.
double RadiusOfCellRobot(double cell);

// The name of the lanes' vertex of a cell: "x5y16".
std::string VertexName(const GridCell& cell);

// The error is that of a robot which cannot be made.
Result<WorldTree> GridTree(std::shared_ptr<const GridProblem> problem);

// Reads a file with cells, and makes its tree.
Result<WorldTree> ReadGridTree(const std::string& path, const GridOptions& options,
                               const AllowedPaths& allowed = AllowedPaths::All());

}  // namespace troupe
