#include "common/picture/labels.h"
#include "common/picture/shading.h"
#include "common/picture/views.h"

namespace troupe {

void DrawNames(Canvas& canvas, const Viewport& viewport, const Drawing& drawing, const std::vector<Rectangle>& boxes,
               const std::vector<Rectangle>& walls) {
  const double u = viewport.unit;
  std::vector<LabelRequest> requests;
  std::vector<std::size_t> robots;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!drawing.extents[i].shown || !viewport.plot.Contains(boxes[i].center())) continue;
    requests.push_back({drawing.world.robots[i].name, boxes[i]});
    robots.push_back(i);
  }
  const auto text_width = [&](const std::string& text, double size) { return canvas.TextWidth(text, {size, {}}); };
  // Names of many robots are a texture, not a text: smaller and paler.
  const bool many = requests.size() > 40;
  const std::vector<double> sizes =
      many ? std::vector<double>{8.5 * u} : std::vector<double>{12.0 * u, 10.0 * u, 8.5 * u};
  const LabelPlan plan = PlaceLabels(requests, walls, viewport.plot, sizes, text_width);
  for (const PlacedLabel& label : plan.labels) {
    const bool stalled = drawing.state.robots[robots[label.request]].stalled;
    const Color& color = stalled ? page::kStalled : many ? page::kQuietText : page::kText;
    canvas.Fill(label.box.Inflated(1.5 * u), WithOpacity(page::kPaper, 0.7));
    canvas.Text(requests[label.request].text, {label.box.min_x, label.box.max_y - 0.15 * plan.size}, TextAnchor::kLeft,
                {plan.size, color});
  }
}

}  // namespace troupe
