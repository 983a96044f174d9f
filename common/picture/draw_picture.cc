#include "common/picture/draw_picture.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "common/base/source_text.h"
#include "common/picture/canvas.h"
#include "common/picture/heat_map.h"
#include "common/picture/viewport.h"
#include "common/picture/views.h"

namespace troupe {
namespace {

// The surroundings of the drawn world: grid and scales below it, frame and caption around it.

struct Caption {
  std::string title;   // the world's name
  std::string detail;  // tick, time, robots
  std::string alarm;   // in red: stalled robots
};

struct GridStep {
  double major = 1.0;  // m
  int parts = 1;       // minor steps in a major one
};

GridStep ChooseStep(const Viewport& viewport) {
  // A round step of at least 55 units, with finer lines where they stay 14 units apart.
  const double least = 55.0 * viewport.unit / viewport.scale;
  GridStep step;
  step.major = RoundDown(least);
  while (step.major < least) step.major = RoundDown(step.major * 2.5);
  const double leading = step.major / std::pow(10.0, std::floor(std::log10(step.major) + 1e-9));
  step.parts = leading > 1.5 && leading < 3.0 ? 2 : 5;
  if (step.major * viewport.scale / step.parts < 14.0 * viewport.unit) step.parts = 1;
  return step;
}

// Calls visit(i) for every whole i with low <= i * step <= high.
template <typename Visit>
void ForEachMultiple(double low, double high, double step, const Visit& visit) {
  // Counting from the first one keeps the loop finite where doubles are coarser than the step.
  const double first = std::ceil(low / step - 1e-9);
  const int count = static_cast<int>(std::clamp(std::floor(high / step + 1e-9) - first, -1.0, 1e4));
  for (int i = 0; i <= count; ++i) visit(first + i);
}

void DrawLines(Canvas& canvas, const Viewport& viewport, double step, double line_width, const Color& color) {
  const Rectangle& region = viewport.region;
  const Rectangle& plot = viewport.plot;
  ForEachMultiple(region.min_x, region.max_x, step, [&](double i) {
    const double x = viewport.ToPage(i * step, 0.0).x();
    canvas.Line({x, plot.min_y}, {x, plot.max_y}, line_width, color);
  });
  ForEachMultiple(region.min_y, region.max_y, step, [&](double i) {
    const double y = viewport.ToPage(0.0, i * step).y();
    canvas.Line({plot.min_x, y}, {plot.max_x, y}, line_width, color);
  });
}

void DrawScaleBar(Canvas& canvas, const Viewport& viewport, double base_line, const TextStyle& style) {
  const double u = viewport.unit;
  const double length = RoundDown(0.2 * viewport.plot.width() / viewport.scale);
  const double right = viewport.plot.max_x;
  const double left = right - length * viewport.scale;
  const double y = base_line - 3.5 * u;
  canvas.Line({left, y}, {right, y}, 1.6 * u, page::kText);
  for (double x : {left, right}) canvas.Line({x, y - 4.0 * u}, {x, y + 4.0 * u}, 1.6 * u, page::kText);
  const std::string text = length >= 1000.0 ? Label(length / 1000.0) + " km"
                           : length >= 1.0  ? Label(length) + " m"
                           : length >= 0.01 ? Label(length * 100.0) + " cm"
                                            : Label(length * 1000.0) + " mm";
  canvas.Text(text, {left - 8.0 * u, base_line}, TextAnchor::kRight, style);
}

void DrawGrid(Canvas& canvas, const Viewport& viewport) {
  canvas.Fill(Rectangle{0.0, 0.0, double(canvas.width()), double(canvas.height())}, page::kPaper);
  canvas.Fill(viewport.plot, page::kGround);
  const GridStep step = ChooseStep(viewport);
  if (step.parts > 1) DrawLines(canvas, viewport, step.major / step.parts, viewport.unit, page::kGridMinor);
  DrawLines(canvas, viewport, step.major, viewport.unit, page::kGridMajor);
}

// The plot's frame and the metres along it.
void DrawFrame(Canvas& canvas, const Viewport& viewport) {
  const double u = viewport.unit;
  const Rectangle& region = viewport.region;
  const Rectangle& plot = viewport.plot;
  canvas.Stroke(plot, u, page::kFrame);
  const double step = ChooseStep(viewport).major;
  const TextStyle style{9.5 * u, page::kQuietText};
  ForEachMultiple(region.min_x, region.max_x, step, [&](double i) {
    const double x = viewport.ToPage(i * step, 0.0).x();
    canvas.Line({x, plot.max_y}, {x, plot.max_y + 4.0 * u}, u, page::kFrame);
    canvas.Text(Label(i * step), {x, plot.max_y + 15.0 * u}, TextAnchor::kMiddle, style);
  });
  ForEachMultiple(region.min_y, region.max_y, step, [&](double i) {
    const double y = viewport.ToPage(0.0, i * step).y();
    canvas.Line({plot.min_x - 4.0 * u, y}, {plot.min_x, y}, u, page::kFrame);
    canvas.Text(Label(i * step), {plot.min_x - 7.0 * u, y + 3.4 * u}, TextAnchor::kRight, style);
  });
}

// Title and details at the lower left, a scale bar of a round length at the lower right.
void DrawCaption(Canvas& canvas, const Viewport& viewport, const Caption& caption) {
  const double u = viewport.unit;
  const double base_line = viewport.plot.max_y + 45.0 * u;
  const TextStyle title{14.0 * u, page::kText, true};
  const TextStyle detail{12.0 * u, page::kQuietText};
  const TextStyle alarm{12.0 * u, page::kStalled};
  DrawScaleBar(canvas, viewport, base_line, detail);

  double x = viewport.plot.min_x;
  const double end = viewport.plot.max_x - 0.2 * viewport.plot.width() - 60.0 * u;
  const auto write = [&](const std::string& text, const TextStyle& style, double share) {
    if (text.empty() || end <= x) return;
    const std::string shown = canvas.Shortened(text, share * (end - x), style);
    canvas.Text(shown, {x, base_line}, TextAnchor::kLeft, style);
    x += canvas.TextWidth(shown, style) + 14.0 * u;
  };
  write(caption.title, title, 0.5);
  write(caption.detail, detail, 1.0);
  write(caption.alarm, alarm, 1.0);
}

Caption MakeCaption(const WorldDescription& world, const WorldState& state, PictureView view) {
  const double seconds = static_cast<double>(state.tick) * world.interval_seconds();
  char time[48];
  std::snprintf(time, sizeof time, "%.*f s", seconds < 1e5 && world.interval_ns % 100'000'000 != 0 ? 3 : 1, seconds);
  std::size_t robots = 0;
  std::size_t stalled = 0;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (!RobotExists(world, RobotId(i))) continue;
    ++robots;
    if (state.robots[i].stalled) ++stalled;
  }
  Caption caption;
  caption.title = world.name;
  caption.detail = "tick " + std::to_string(state.tick) + ", " + time + ", " + CountText(robots, "robot");
  if (view == PictureView::kSide) caption.detail += ", seen along +y";
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
  for (RobotExtent& extent : extents) extent.shown = extent.shown && !outside(extent.box);
}

cairo_status_t AppendBytes(void* bytes, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Color SolidColor(const Drawing& drawing, const Solid& solid) {
  const Color& color = drawing.world.model(solid.model).color;
  return solid.robot ? RobotColor(color, solid.height) : ObjectColor(color, solid.height);
}

Result<std::string> DrawPicture(const WorldDescription& world, const WorldState& state,
                                const std::vector<ScanFan>& fans, const PictureOptions& options,
                                const std::vector<Mark>& marks, const HeatMap* heat) {
  if (const Status problem = CheckPictureOptions(options); !problem.ok()) return problem.error();
  std::vector<Solid> solids = CollectSolids(world, state);
  std::vector<RobotExtent> extents = RobotExtents(solids, world, state);
  const bool top = options.view == PictureView::kTop;
  if (!top && options.meters) KeepSlice(options, solids, extents);
  const Drawing drawing{world, state, fans, marks, solids, extents};
  Rectangle contents = top ? TopContents(drawing) : SideContents(drawing);
  if (top && heat != nullptr) {
    heat->ForEachCell([&](const Rectangle& cell, double) { contents.Extend(cell); });
  }
  const Viewport viewport = MakeViewport(contents, options);
  Canvas canvas(options.format, viewport.width, viewport.height);
  DrawGrid(canvas, viewport);
  canvas.ClipTo(viewport.plot);
  if (top) {
    if (heat != nullptr) DrawHeat(canvas, viewport, *heat);
    DrawTopView(canvas, viewport, drawing);
  } else {
    DrawSideView(canvas, viewport, drawing);
  }
  if (top && heat != nullptr) DrawHeatLegend(canvas, viewport, *heat);
  canvas.ClipNothing();
  DrawFrame(canvas, viewport);
  DrawCaption(canvas, viewport, MakeCaption(world, state, options.view));
  return canvas.Finish();
}

Result<std::string> EncodePng(int width, int height, std::span<const std::uint8_t> rgb) {
  std::string bytes;
  cairo_surface_t* const surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  if (unsigned char* const pixels = cairo_image_surface_get_data(surface)) {  // none without memory
    const int stride = cairo_image_surface_get_stride(surface);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t from =
            3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
        const std::uint32_t pixel =
            (std::uint32_t{rgb[from]} << 16) | (std::uint32_t{rgb[from + 1]} << 8) | rgb[from + 2];
        std::memcpy(pixels + static_cast<std::ptrdiff_t>(y) * stride + 4 * static_cast<std::ptrdiff_t>(x), &pixel, 4);
      }
    }
    cairo_surface_mark_dirty(surface);
  }
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface, AppendBytes, &bytes);
  cairo_surface_destroy(surface);
  if (status != CAIRO_STATUS_SUCCESS) return Error{{}, cairo_status_to_string(status)};
  return bytes;
}

}  // namespace troupe
