#include "common/picture/surroundings.h"

#include <algorithm>
#include <cmath>

#include "common/picture/shading.h"

namespace troupe {
namespace {

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

}  // namespace

void DrawGrid(Canvas& canvas, const Viewport& viewport) {
  canvas.Fill(Rectangle{0.0, 0.0, double(canvas.width()), double(canvas.height())}, page::kPaper);
  canvas.Fill(viewport.plot, page::kGround);
  const GridStep step = ChooseStep(viewport);
  if (step.parts > 1) DrawLines(canvas, viewport, step.major / step.parts, viewport.unit, page::kGridMinor);
  DrawLines(canvas, viewport, step.major, viewport.unit, page::kGridMajor);
}

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

}  // namespace troupe
