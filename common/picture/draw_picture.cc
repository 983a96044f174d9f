#include "common/picture/draw_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/picture/shading.h"
#include "common/picture/surroundings.h"
#include "common/picture/views.h"

namespace troupe {
namespace {

std::string Count(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

Caption MakeCaption(const WorldDescription& world, const WorldState& state, PictureView view) {
  const double seconds = static_cast<double>(state.tick) * world.interval_seconds();
  char time[48];
  std::snprintf(time, sizeof time, "%.*f s", seconds < 1e5 && world.interval_ns % 100'000'000 != 0 ? 3 : 1, seconds);
  Caption caption;
  caption.title = world.name;
  caption.detail = "tick " + std::to_string(state.tick) + ", " + time + ", " + Count(world.robots.size(), "robot");
  if (view == PictureView::kSide) caption.detail += ", seen along +y";
  const auto stalled =
      std::count_if(state.robots.begin(), state.robots.end(), [](const RobotState& robot) { return robot.stalled; });
  if (stalled > 0) caption.alarm = std::to_string(stalled) + " stalled";
  return caption;
}

// A side view of a part looks at a slice: nothing in front of it may hide it.
void KeepSlice(const PictureOptions& options, std::vector<Solid>& solids, std::vector<RobotExtent>& extents) {
  Rectangle everything = Rectangle::Nothing();
  for (const Solid& solid : solids) everything.Extend(solid.box);
  for (const RobotExtent& extent : extents) everything.Extend(extent.box);
  const double middle = options.center ? options.center->y() : everything.empty() ? 0.0 : everything.center().y();
  const double reach = 0.5 * *options.meters;
  const auto outside = [&](const Rectangle& box) { return box.max_y < middle - reach || box.min_y > middle + reach; };
  std::erase_if(solids, [&](const Solid& solid) { return outside(solid.box); });
  for (RobotExtent& extent : extents) extent.shown = !outside(extent.box);
}

}  // namespace

Status CheckPictureOptions(const PictureOptions& options) {
  if (options.width && (*options.width < kMinPictureWidth || *options.width > kMaxPictureWidth)) {
    return Error{{},
                 "found a picture width of " + std::to_string(*options.width) + ", expected " +
                     std::to_string(kMinPictureWidth) + " to " + std::to_string(kMaxPictureWidth) + " pixels"};
  }
  const auto out_of_bounds = [](double value) { return !(std::abs(value) <= 1e9); };
  if (options.center && (out_of_bounds(options.center->x()) || out_of_bounds(options.center->y()))) {
    return Error{{}, "found a picture centre that is not a place, expected x and y within 1e9 m"};
  }
  if (options.meters && !(*options.meters >= 0.01 && *options.meters <= 1e9)) {
    return Error{{}, "found a picture " + Label(*options.meters) + " m wide, expected 0.01 m to 1e9 m"};
  }
  return std::nullopt;
}

Color SolidColor(const Drawing& drawing, const Solid& solid) {
  const Color& color = drawing.world.model(solid.model).color;
  return solid.robot ? RobotColor(color, solid.height) : ObjectColor(color, solid.height);
}

Result<std::string> DrawPicture(const WorldDescription& world, const WorldState& state,
                                const std::vector<ScanFan>& fans, const PictureOptions& options) {
  if (const Status problem = CheckPictureOptions(options)) return *problem;
  std::vector<Solid> solids = CollectSolids(world, state);
  std::vector<RobotExtent> extents = RobotExtents(solids, state);
  const bool top = options.view == PictureView::kTop;
  if (!top && options.meters) KeepSlice(options, solids, extents);
  const Drawing drawing{world, state, fans, solids, extents};
  const Viewport viewport = MakeViewport(top ? TopContents(drawing) : SideContents(drawing), options);
  Canvas canvas(options.format, viewport.width, viewport.height);
  DrawGrid(canvas, viewport);
  canvas.ClipTo(viewport.plot);
  if (top) {
    DrawTopView(canvas, viewport, drawing);
  } else {
    DrawSideView(canvas, viewport, drawing);
  }
  canvas.ClipNothing();
  DrawFrame(canvas, viewport);
  DrawCaption(canvas, viewport, MakeCaption(world, state, options.view));
  return canvas.Finish();
}

}  // namespace troupe
