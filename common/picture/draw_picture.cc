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

// A side view of a part shows a slice: solids in front of it are left out.
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

Color SolidColor(const Drawing& drawing, const Solid& solid) {
  const Color& color = drawing.world.model(solid.model).color;
  return solid.robot ? RobotColor(color, solid.height) : ObjectColor(color, solid.height);
}

Result<std::string> DrawPicture(const WorldDescription& world, const WorldState& state,
                                const std::vector<ScanFan>& fans, const PictureOptions& options,
                                const std::vector<Mark>& marks) {
  if (const Status problem = CheckPictureOptions(options); !problem.ok()) return problem.error();
  std::vector<Solid> solids = CollectSolids(world, state);
  std::vector<RobotExtent> extents = RobotExtents(solids, state);
  const bool top = options.view == PictureView::kTop;
  if (!top && options.meters) KeepSlice(options, solids, extents);
  const Drawing drawing{world, state, fans, marks, solids, extents};
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
