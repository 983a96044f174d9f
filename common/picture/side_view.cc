#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/picture/shading.h"
#include "common/picture/views.h"

namespace troupe {
namespace {

constexpr double kObjectOpacity = 0.88;
constexpr double kFarthestFade = 0.2;  // share of the page's colour in that of the farthest solids

// The solid's box in the plane of x and z.
Rectangle Elevation(const Solid& solid) {
  return {solid.box.min_x, solid.z.min, solid.box.max_x, solid.z.max};
}

// The maps against the sky, as few boxes: drawn in full, the walls of a building would hide its inside.
void DrawSilhouettes(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  std::vector<Rectangle> boxes;
  for (const Solid& solid : drawing.solids) {
    if (solid.kind != SolidKind::kMap) continue;
    if (solid.area != nullptr) boxes.push_back(Elevation(solid));
    for (const Polygon& loop : solid.loops) {
      const Rectangle box = BoundingBox(loop);
      boxes.push_back({box.min_x, solid.z.min, box.max_x, solid.z.max});
    }
  }
  std::sort(boxes.begin(), boxes.end(), [](const Rectangle& a, const Rectangle& b) {
    return std::tie(a.min_y, a.max_y, a.min_x, a.max_x) < std::tie(b.min_y, b.max_y, b.min_x, b.max_x);
  });
  std::vector<Rectangle> merged;
  for (const Rectangle& box : boxes) {
    const bool joins = !merged.empty() && box.min_y == merged.back().min_y && box.max_y == merged.back().max_y &&
                       box.min_x <= merged.back().max_x;
    if (joins) {
      merged.back().Extend(box);
    } else {
      merged.push_back(box);
    }
  }
  for (const Rectangle& box : merged) canvas.Fill(viewport.ToPage(box), {0.180, 0.215, 0.270, 0.10});
}

// An arrow on the largest part of each robot, as long as its heading shows in this view.
void DrawHeadings(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  std::vector<Rectangle> largest(drawing.state.robots.size());
  const auto area = [](const Rectangle& box) { return box.width() * box.height(); };
  for (const Solid& solid : drawing.solids) {
    if (!solid.robot) continue;
    Rectangle& part = largest[solid.robot->index()];
    const Rectangle box = viewport.ToPage(Elevation(solid));
    if (area(box) > area(part)) part = box;
  }
  for (std::size_t i = 0; i < largest.size(); ++i) {
    const double ahead = std::cos(drawing.state.robots[i].X_WR.heading);
    const double size = 0.20 * std::min(largest[i].width(), 1.6 * largest[i].height());
    if (size < 2.0 * viewport.unit) continue;
    const Vec2 c = largest[i].center();
    const std::vector<Polygon> arrow{
        {c + Vec2(ahead * size, 0.0), c + Vec2(-ahead * size, 0.6 * size), c + Vec2(-ahead * size, -0.6 * size)}};
    canvas.Fill(arrow, {1.0, 1.0, 1.0, 0.95});
    canvas.Stroke(arrow, 0.6 * viewport.unit, {0.1, 0.12, 0.16, 0.8});
  }
}

void DrawGround(Canvas& canvas, const Viewport& viewport) {
  const Rectangle& plot = viewport.plot;
  const double y = viewport.ToPage(0.0, 0.0).y();
  canvas.Fill(Rectangle{plot.min_x, y, plot.max_x, plot.max_y}, {0.93, 0.94, 0.95, 1.0});
  canvas.Line({plot.min_x, y}, {plot.max_x, y}, 1.4 * viewport.unit, {0.35, 0.39, 0.45, 1.0});
}

void DrawRays(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  for (const ScanFan& fan : drawing.fans) {
    double min_x = fan.X_WS.x;
    double max_x = fan.X_WS.x;
    for (std::size_t i = 0; i < fan.ranges.size(); ++i) {
      const double x = fan.X_WS.x + fan.ranges[i] * std::cos(fan.X_WS.heading + fan.bearings[i]);
      min_x = std::min(min_x, x);
      max_x = std::max(max_x, x);
    }
    canvas.Line(viewport.ToPage(min_x, fan.X_WS.z), viewport.ToPage(max_x, fan.X_WS.z), 1.6 * viewport.unit,
                WithOpacity(page::kScan, 0.35));
  }
}

}  // namespace

Rectangle SideContents(const Drawing& drawing) {
  Rectangle contents = Rectangle::Nothing();
  Rectangle maps = Rectangle::Nothing();
  for (const Solid& solid : drawing.solids) (solid.kind == SolidKind::kMap ? maps : contents).Extend(Elevation(solid));
  for (const RobotExtent& extent : drawing.extents) {
    if (extent.shown) contents.Extend(Rectangle{extent.box.min_x, extent.z.min, extent.box.max_x, extent.z.max});
  }
  if (contents.empty()) return maps;
  // Walls may be cut off above: the solids between them are the picture.
  contents.min_x = std::min(contents.min_x, maps.min_x);
  contents.max_x = std::max(contents.max_x, maps.max_x);
  return contents;
}

void DrawSideView(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  const double u = viewport.unit;
  DrawGround(canvas, viewport);
  DrawSilhouettes(canvas, viewport, drawing);
  std::vector<const Solid*> solids;
  double nearest = 0.0;
  double farthest = 0.0;
  for (const Solid& solid : drawing.solids) {
    if (solid.kind == SolidKind::kMap) continue;
    const double depth = solid.box.center().y();
    nearest = solids.empty() ? depth : std::min(nearest, depth);
    farthest = solids.empty() ? depth : std::max(farthest, depth);
    solids.push_back(&solid);
  }
  DrawRays(canvas, viewport, drawing);

  // From the farthest to the nearest; the farther, the paler.
  std::stable_sort(solids.begin(), solids.end(),
                   [](const Solid* a, const Solid* b) { return a->box.center().y() > b->box.center().y(); });
  for (const Solid* solid : solids) {
    const ModelDescription& model = drawing.world.model(solid->model);
    const double distance = farthest > nearest ? (solid->box.center().y() - nearest) / (farthest - nearest) : 0.0;
    const Color color = Mix(SolidColor(drawing, *solid), page::kGround, kFarthestFade * distance);
    const double opacity =
        std::clamp(model.color.a, 0.0, 1.0) * (solid->kind == SolidKind::kObject ? kObjectOpacity : 1.0);
    const Rectangle box = viewport.ToPage(Elevation(*solid));
    canvas.Fill(box, WithOpacity(color, opacity));
    if (box.width() > 2.0 * u) canvas.Stroke(box, 0.7 * u, WithOpacity(OutlineColor(color), opacity));
  }

  DrawHeadings(canvas, viewport, drawing);
  DrawMarks(canvas, viewport, drawing, PictureView::kSide, MarkShape::kLine);
  DrawMarks(canvas, viewport, drawing, PictureView::kSide, MarkShape::kDot);

  std::vector<Rectangle> boxes;
  for (std::size_t i = 0; i < drawing.extents.size(); ++i) {
    const RobotExtent& extent = drawing.extents[i];
    boxes.push_back(viewport.ToPage(Rectangle{extent.box.min_x, extent.z.min, extent.box.max_x, extent.z.max}));
    if (!extent.shown || !drawing.state.robots[i].stalled) continue;
    boxes.back() = boxes.back().Inflated(3.0 * u);
    canvas.Stroke(boxes.back(), 3.4 * u, {1.0, 1.0, 1.0, 0.75});
    canvas.Stroke(boxes.back(), 1.8 * u, page::kStalled);
  }
  DrawNames(canvas, viewport, drawing, boxes, {});
}

}  // namespace troupe
