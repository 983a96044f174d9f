#include "common/picture/views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace troupe {
namespace {

constexpr double kOverhang =
    0.1;  // m: a solid higher above the ground is drawn with the solids below it showing through
constexpr double kOverhangOpacity = 0.62;
constexpr double kCoveredOpacity = 0.28;  // of the parts of a robot that are drawn again over the table above it
constexpr std::size_t kManyFans = 300;
constexpr double kMinRobot = 7.0;  // units: robots that would be smaller are drawn as a pin

// The fan as an area of the plane, frame W.
Polygon FanOutline(const ScanFan& fan) {
  Polygon outline{fan.X_WS.translation()};
  const auto add = [&](double bearing, double range) {
    const double angle = fan.X_WS.heading + bearing;
    outline.push_back(fan.X_WS.translation() + range * Vec2(std::cos(angle), std::sin(angle)));
  };
  if (fan.ranges.size() == 1) {
    // A single ray becomes a slim cone, because a line is hard to see.
    const double half = std::min(0.5 * fan.fov, 0.05);
    for (double side : {-1.0, -0.5, 0.0, 0.5, 1.0}) add(fan.bearings[0] + side * half, fan.ranges[0]);
  } else {
    for (std::size_t i = 0; i < fan.ranges.size(); ++i) add(fan.bearings[i], fan.ranges[i]);
  }
  return outline;
}

// All fans together, so that overlaps are no darker; their edges distinguish them.
void DrawFans(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  std::vector<Polygon> outlines;
  for (const ScanFan& fan : drawing.fans) outlines.push_back(FanOutline(fan));
  outlines = viewport.ToPage(outlines);
  canvas.FillUnion(outlines, WithOpacity(page::kScan, 0.13));
  // The more fans, the fainter their edges, which would hide a swarm.
  // Hundreds of edges are a grey haze.
  if (outlines.size() > kManyFans) return;
  const double opacity = std::clamp(1.4 / std::sqrt(1.0 + static_cast<double>(outlines.size())), 0.05, 0.3);
  for (const Polygon& outline : outlines) {
    canvas.Stroke({outline}, 0.7 * viewport.unit, WithOpacity(page::kScan, opacity));
  }
}

// A floor plate, below all rays: the height of the lowest one is `rays`.
bool IsUnder(const Solid& solid, double rays) {
  return solid.kind == SolidKind::kObject && solid.z.max < std::min(rays, kOverhang);
}

double LowestRays(const Drawing& drawing) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const ScanFan& fan : drawing.fans) lowest = std::min(lowest, fan.X_WS.z);
  return lowest;
}

bool IsOverhang(const Solid& solid) {
  return solid.kind == SolidKind::kObject && solid.z.min > kOverhang;
}

// Of a bar its width, of other outlines about half of their size, in units of the loops.
double ThicknessOf(const std::vector<Polygon>& loops) {
  double area = 0.0;
  double length = 0.0;
  for (const Polygon& loop : loops) {
    area += SignedArea(loop);
    for (std::size_t i = 0; i < loop.size(); ++i) length += (loop[(i + 1) % loop.size()] - loop[i]).norm();
  }
  return length > 0.0 ? 2.0 * std::fabs(area) / length : 0.0;
}

void DrawSolid(Canvas& canvas, const Viewport& viewport, const Drawing& drawing, const Solid& solid, double opacity) {
  const std::vector<Polygon> loops = viewport.ToPage(solid.loops);
  const Color color = SolidColor(drawing, solid);
  opacity *= std::clamp(drawing.world.model(solid.model).color.a, 0.0, 1.0);
  canvas.Fill(loops, WithOpacity(color, opacity));
  const double u = viewport.unit;
  const double size = std::min(solid.box.width(), solid.box.height()) * viewport.scale;
  if (std::min(size, 2.0 * ThicknessOf(loops)) > 2.5 * u) {
    canvas.Stroke(loops, 0.7 * u, WithOpacity(OutlineColor(color), std::min(1.0, opacity + 0.2)));
  } else {
    canvas.Stroke(loops, 0.7 * u, WithOpacity(color, opacity));  // as a line, too thin to be seen otherwise
  }
}

// The box around the widest part of each robot, m, frame R.
std::vector<Rectangle> WidestParts(const Drawing& drawing) {
  std::vector<Rectangle> widest(drawing.state.robots.size(), Rectangle::Nothing());
  for (const Solid& solid : drawing.solids) {
    if (!solid.robot) continue;
    const Transform2 X_WR(drawing.state.robots[solid.robot->index()].X_WR);
    Rectangle box = Rectangle::Nothing();
    for (const Polygon& loop : solid.loops) {
      for (const Vec2& p_W : loop) box.Extend(X_WR.InverseTransform(p_W));
    }
    Rectangle& other = widest[solid.robot->index()];
    if (other.empty() || box.width() * box.height() > other.width() * other.height()) other = box;
  }
  return widest;
}

// A wedge on the robot that points ahead. `part`: where it is on the robot, frame R.
void DrawNose(Canvas& canvas, const Viewport& viewport, const Pose& X_WR, const Rectangle& part, double opacity) {
  if (part.empty()) return;
  const Transform2 transform(X_WR);
  const Vec2 center = part.center();
  const double front = part.max_x - center.x();
  const double side = 0.62 * std::min(0.5 * part.height(), front);
  const auto at = [&](double x, double y) { return transform * Vec2(center.x() + x, center.y() + y); };
  const Polygon nose{at(1.02 * front, 0.0), at(0.3 * front, side), at(0.48 * front, 0.0), at(0.3 * front, -side)};
  const std::vector<Polygon> loops = viewport.ToPage(std::vector<Polygon>{nose});
  canvas.Fill(loops, {1.0, 1.0, 1.0, 0.95 * opacity});
  canvas.Stroke(loops, 0.6 * viewport.unit, {0.1, 0.12, 0.16, 0.8 * opacity});
}

// A robot too small to be seen at this scale: a dot with a line ahead.
void DrawPin(Canvas& canvas, const Viewport& viewport, const Pose& X_WR, const Color& color) {
  const double u = viewport.unit;
  const Vec2 at = viewport.ToPage(X_WR.translation());
  const Vec2 ahead(std::cos(X_WR.heading), -std::sin(X_WR.heading));
  canvas.Line(at, at + 7.5 * u * ahead, 1.4 * u, OutlineColor(RobotColor(color, 0.5)));
  canvas.FillCircle(at, 3.4 * u, OutlineColor(RobotColor(color, 0.5)));
  canvas.FillCircle(at, 2.6 * u, RobotColor(color, 0.7));
}

// The robot's box on the page, or that of its pin.
Rectangle BoxOnPage(const Viewport& viewport, const RobotExtent& extent) {
  const Rectangle box = viewport.ToPage(extent.box);
  const double missing = kMinRobot * viewport.unit - std::max(box.width(), box.height());
  return missing > 0.0 ? box.Inflated(0.5 * missing) : box;
}

// Higher solids are drawn later, and each robot's nose right after its highest part.
struct Layer {
  double top;
  double bottom;
  const Solid* solid = nullptr;
  std::optional<RobotId> nose;
};

std::vector<Layer> SortedLayers(const Drawing& drawing) {
  const double rays = drawing.fans.empty() ? -1.0 : LowestRays(drawing);
  std::vector<Layer> layers;
  for (const Solid& solid : drawing.solids) {
    if (solid.kind == SolidKind::kMap || IsUnder(solid, rays)) continue;
    layers.push_back({solid.z.max, solid.z.min, &solid, std::nullopt});
  }
  for (std::size_t i = 0; i < drawing.extents.size(); ++i) {
    if (!drawing.extents[i].shown) continue;
    layers.push_back({drawing.extents[i].z.max, drawing.extents[i].z.max, nullptr, RobotId(i)});
  }
  std::stable_sort(layers.begin(), layers.end(), [](const Layer& a, const Layer& b) {
    return std::tie(a.top, a.bottom) < std::tie(b.top, b.bottom);
  });
  return layers;
}

// Draws all but the walls. A robot under a table is drawn a second time over it, faintly.
void DrawLayers(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  const std::vector<Rectangle> widest = WidestParts(drawing);
  const auto draw = [&](const Layer& layer, double opacity) {
    if (layer.solid) {
      DrawSolid(canvas, viewport, drawing, *layer.solid, opacity);
      return;
    }
    const std::size_t robot = layer.nose->index();
    const Pose& X_WR = drawing.state.robots[robot].X_WR;
    const Rectangle box = viewport.ToPage(drawing.extents[robot].box);
    if (std::max(box.width(), box.height()) < kMinRobot * viewport.unit) {
      DrawPin(canvas, viewport, X_WR, drawing.world.model(drawing.world.robots[robot].root).color);
    } else {
      DrawNose(canvas, viewport, X_WR, widest[robot], opacity);
    }
  };
  const std::vector<Layer> layers = SortedLayers(drawing);
  std::vector<const Solid*> overhangs;
  for (const Layer& layer : layers) {
    const bool overhang = layer.solid && IsOverhang(*layer.solid);
    draw(layer, overhang ? kOverhangOpacity : 1.0);
    if (overhang) overhangs.push_back(layer.solid);
  }
  std::vector<bool> covered(drawing.extents.size(), false);
  for (std::size_t i = 0; i < covered.size(); ++i) {
    const RobotExtent& extent = drawing.extents[i];
    covered[i] = std::any_of(overhangs.begin(), overhangs.end(), [&](const Solid* overhang) {
      return overhang->z.max > extent.z.max && overhang->box.Overlaps(extent.box);
    });
  }
  for (const Layer& layer : layers) {
    const std::optional<RobotId> robot = layer.solid ? layer.solid->robot : layer.nose;
    if (robot && covered[robot->index()]) draw(layer, kCoveredOpacity);
  }
}

// Floor plates, which would hide the rays above them.
void DrawPlates(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  std::vector<const Solid*> plates;
  for (const Solid& solid : drawing.solids) {
    if (IsUnder(solid, LowestRays(drawing))) plates.push_back(&solid);
  }
  std::stable_sort(plates.begin(), plates.end(), [](const Solid* a, const Solid* b) { return a->z.max < b->z.max; });
  for (const Solid* plate : plates) DrawSolid(canvas, viewport, drawing, *plate, 1.0);
}

// Walls are below everything else: a robot inside a wall that it cannot hit must still be seen. Returns their boxes.
std::vector<Rectangle> DrawWalls(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  std::vector<Rectangle> walls;
  for (const Solid& solid : drawing.solids) {
    if (solid.kind != SolidKind::kMap) continue;
    const Color color = WallColor(drawing.world.model(solid.model).color);
    canvas.Fill(viewport.ToPage(solid.loops), color);
    if (solid.area != nullptr) canvas.Fill(MakePixelMask(*solid.area, solid.X_WM, viewport), color);
    for (const Rectangle& part : solid.cover) {
      const Rectangle wall = viewport.ToPage(part);
      if (wall.Overlaps(viewport.plot)) walls.push_back(wall);
    }
  }
  return walls;
}

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

Rectangle TopContents(const Drawing& drawing) {
  Rectangle contents = Rectangle::Nothing();
  for (const Solid& solid : drawing.solids) contents.Extend(solid.box);
  for (const RobotExtent& extent : drawing.extents) {
    if (extent.shown) contents.Extend(extent.box);
  }
  return contents;
}

void DrawTopView(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  if (!drawing.fans.empty()) DrawPlates(canvas, viewport, drawing);
  DrawFans(canvas, viewport, drawing);
  DrawMarks(canvas, viewport, drawing, PictureView::kTop, MarkShape::kArea);
  const std::vector<Rectangle> walls = DrawWalls(canvas, viewport, drawing);

  std::vector<Rectangle> boxes;
  for (const RobotExtent& extent : drawing.extents) boxes.push_back(BoxOnPage(viewport, extent));
  DrawLayers(canvas, viewport, drawing);
  DrawZones(canvas, viewport, drawing);
  DrawMarks(canvas, viewport, drawing, PictureView::kTop, MarkShape::kLine);
  DrawMarks(canvas, viewport, drawing, PictureView::kTop, MarkShape::kDot);

  const double u = viewport.unit;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!drawing.extents[i].shown || !drawing.state.robots[i].stalled) continue;
    const Vec2 center = boxes[i].center();
    const double radius = 0.58 * std::max(boxes[i].width(), boxes[i].height()) + 2.0 * u;
    canvas.StrokeCircle(center, radius, 3.4 * u, {1.0, 1.0, 1.0, 0.75});
    canvas.StrokeCircle(center, radius, 1.8 * u, page::kStalled);
    boxes[i] = {center.x() - radius, center.y() - radius, center.x() + radius, center.y() + radius};
  }
  DrawNames(canvas, viewport, drawing, boxes, walls);
}

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
