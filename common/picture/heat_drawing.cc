// A heat map under the bodies of a picture, and its legend.
//
// The colour follows the square root of the time: cells in which robots stop for minutes would else leave all ways on
// which they drive pale.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "common/base/source_text.h"
#include "common/picture/heat_map.h"
#include "common/picture/views.h"

namespace troupe {
namespace {

// From the least to the most: pale yellow, orange, dark red. They are told apart without colours, too.
constexpr Color kHeatColors[] = {{1.0, 0.95, 0.70, 1.0},
                                 {0.99, 0.75, 0.35, 1.0},
                                 {0.94, 0.42, 0.18, 1.0},
                                 {0.74, 0.09, 0.15, 1.0},
                                 {0.40, 0.0, 0.13, 1.0}};
constexpr double kHeatOpacity = 0.85;
constexpr std::size_t kLegendSteps = 40;

Color HeatColor(double share) {
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(std::size(kHeatColors) - 1);
  const auto below = std::min(static_cast<std::size_t>(at), std::size(kHeatColors) - 2);
  return WithOpacity(Mix(kHeatColors[below], kHeatColors[below + 1], at - static_cast<double>(below)), kHeatOpacity);
}

std::string TimeText(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, seconds < 10.0 ? "%.1f s" : "%.0f s", seconds);
  return text;
}

}  // namespace

void DrawHeat(Canvas& canvas, const Viewport& viewport, const HeatMap& heat) {
  const double most = heat.most();
  heat.ForEachCell([&](const Rectangle& cell, double seconds) {
    if (!cell.Overlaps(viewport.region)) return;  // far from the page the numbers of Cairo overflow
    canvas.Fill(viewport.ToPage(cell), HeatColor(std::sqrt(seconds / most)));
  });
}

// At the upper right of the plot: what the colours mean.
void DrawHeatLegend(Canvas& canvas, const Viewport& viewport, const HeatMap& heat) {
  const double u = viewport.unit;
  const Rectangle& plot = viewport.plot;
  const double width = 150.0 * u;
  const double right = plot.max_x - 12.0 * u;
  const double left = right - width;
  const double top = plot.min_y + 12.0 * u;
  const TextStyle style{10.0 * u, page::kText};
  char size[64];
  std::snprintf(size, sizeof size, " in %.3g m x %.3g m", heat.cell(), heat.cell());
  std::string title = "time of " + std::string(NameOf(heat.kind())) + size;
  if (heat.runs() != 1) title += ", " + CountText(heat.runs(), "run");
  const double text_width = std::max(width, canvas.TextWidth(title, style));
  canvas.Fill(Rectangle{right - text_width - 8.0 * u, top - 6.0 * u, right + 8.0 * u, top + 46.0 * u},
              WithOpacity(page::kPaper, 0.9));
  canvas.Text(title, {right, top + 8.0 * u}, TextAnchor::kRight, style);
  if (heat.empty()) return canvas.Text("none", {right, top + 26.0 * u}, TextAnchor::kRight, style);
  const double step = width / static_cast<double>(kLegendSteps);
  for (std::size_t i = 0; i < kLegendSteps; ++i) {
    const double x = left + step * static_cast<double>(i);
    canvas.Fill(Rectangle{x, top + 14.0 * u, x + step, top + 26.0 * u},
                HeatColor((static_cast<double>(i) + 0.5) / static_cast<double>(kLegendSteps)));
  }
  const double most = heat.most();
  canvas.Text("0", {left, top + 38.0 * u}, TextAnchor::kLeft, style);
  canvas.Text(TimeText(0.25 * most), {left + 0.5 * width, top + 38.0 * u}, TextAnchor::kMiddle, style);
  canvas.Text(TimeText(most), {right, top + 38.0 * u}, TextAnchor::kRight, style);
}

}  // namespace troupe
