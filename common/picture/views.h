// The drawing of the two views inside the plot.
//
// Shared by both views: the order in which things are drawn decides what hides what, since there is no depth buffer.
// Stable sorts, so that equal heights keep the order of the world and a picture its bytes.
#pragma once

#include <vector>

#include "common/picture/canvas.h"
#include "common/picture/heat_map.h"
#include "common/picture/solids.h"
#include "common/picture/viewport.h"

namespace troupe {

// The input of a view.
struct Drawing {
  const WorldDescription& world;
  const WorldState& state;
  const std::vector<ScanFan>& fans;
  const std::vector<Mark>& marks;
  const std::vector<Solid>& solids;
  const std::vector<RobotExtent>& extents;
};

// The extent of the solids in the view's plane.
Rectangle TopContents(const Drawing& drawing);
Rectangle SideContents(const Drawing& drawing);

void DrawTopView(Canvas& canvas, const Viewport& viewport, const Drawing& drawing);
void DrawSideView(Canvas& canvas, const Viewport& viewport, const Drawing& drawing);

// The cells of a heat map in the plane of a top view, and the legend above all else.
void DrawHeat(Canvas& canvas, const Viewport& viewport, const HeatMap& heat);
void DrawHeatLegend(Canvas& canvas, const Viewport& viewport, const HeatMap& heat);

// The marks of one shape, in the view's plane.
void DrawMarks(Canvas& canvas, const Viewport& viewport, const Drawing& drawing, PictureView view, MarkShape shape);

// The zones of the world on the levels of the solids, from above.
void DrawZones(Canvas& canvas, const Viewport& viewport, const Drawing& drawing);

// The colour of an object or a part of a robot, shaded by its height; opaque.
Color SolidColor(const Drawing& drawing, const Solid& solid);

// The robots' names beside their boxes on the page, stalled ones in red.
void DrawNames(Canvas& canvas, const Viewport& viewport, const Drawing& drawing, const std::vector<Rectangle>& boxes,
               const std::vector<Rectangle>& walls);

}  // namespace troupe
