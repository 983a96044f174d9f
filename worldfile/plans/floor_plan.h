// FloorPlan: the lines of a drawing (DXF, SVG) by layers, in metres, and the walls that become of them.
//
// Drawings come from strangers: what a few bytes can stand for (blocks in blocks, rows of blocks, long curves) is
// limited by the number of lines that come of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/result.h"
#include "troupe/vec2.h"

namespace troupe {

inline constexpr std::size_t kMaxPlanLines = 200'000;

struct PlanLine {
  Vec2 start{0.0, 0.0};  // m, y up
  Vec2 end{0.0, 0.0};
};

struct PlanLayer {
  std::string name;
  std::vector<PlanLine> lines;  // in the order of the file, none of them shorter than a millimetre
};

struct FloorPlan {
  std::vector<PlanLayer> layers;  // in the order in which they come in the file
  std::vector<Warning> warnings;
};

// The length of a unit of the file in metres; nothing: what the file says, and an error if it says nothing.
using PlanUnit = std::optional<double>;

// A drawing exchange file of AutoCAD as text, R12 to 2018: lines, polylines with bulges, arcs and circles, also in
// blocks that are inserted with scales, turns, rows and columns; layers and $INSUNITS. Ellipses and splines, texts,
// hatches and dimensions are left out, the former two with a warning.
Result<FloorPlan> ReadDxfPlan(std::string_view text, const std::string& path, PlanUnit unit);

// A drawing of SVG 1.1: paths, lines, polylines, polygons, rectangles, circles and ellipses with their transforms.
// Layers are the groups of Inkscape, else the ids of the outermost groups. The unit is that of `width` with `viewBox`.
// What is not displayed, in `defs` or in a clip path is left out.
Result<FloorPlan> ReadSvgPlan(std::string_view text, const std::string& path, PlanUnit unit);

// By the file's ending, .dxf or .svg.
Result<FloorPlan> ReadFloorPlan(const std::string& path, PlanUnit unit);

// The layers of a drawing that are walls, by their names with * and ?: the first that fits counts.
struct PlanRule {
  std::string layer;
  double height = 2.5;  // m
};

struct PlanWalls {
  double thickness = 0.1;       // m
  double height = 2.5;          // m, without rules
  std::vector<PlanRule> rules;  // none: all layers are walls
};

// A world file of Stage with a model for each layer: a block for each line, longer by half of the thickness at both
// ends. Lines that are drawn twice are one. The lower left corner of all is the origin. The error: no layer fits.
Result<std::string> PlanWorldText(const FloorPlan& plan, const PlanWalls& walls, const std::string& source);

}  // namespace troupe
