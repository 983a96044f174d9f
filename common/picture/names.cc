#include "common/picture/labels.h"
#include "common/picture/shading.h"
#include "common/picture/views.h"

namespace troupe {
namespace {

constexpr std::size_t kMany = 20;   // robots: from here on the common prefix of all names is left out
constexpr std::size_t kCrowd = 40;  // robots: from here on names are small and pale

// The common prefix of all names, without digits at its end; nothing if that would leave a name empty.
std::string CommonStart(const std::vector<RobotDescription>& robots) {
  std::string start = robots.front().name;
  for (const RobotDescription& robot : robots) {
    while (!robot.name.starts_with(start)) start.pop_back();
  }
  while (!start.empty() && start.back() >= '0' && start.back() <= '9') start.pop_back();
  for (const RobotDescription& robot : robots) {
    if (robot.name == start) return "";
  }
  return start;
}

}  // namespace

void DrawNames(Canvas& canvas, const Viewport& viewport, const Drawing& drawing, const std::vector<Rectangle>& boxes,
               const std::vector<Rectangle>& walls) {
  const double u = viewport.unit;
  const std::vector<RobotDescription>& all = drawing.world.robots;
  const std::size_t skipped = all.size() > kMany ? CommonStart(all).size() : 0;
  std::vector<LabelRequest> requests;
  std::vector<std::size_t> robots;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!drawing.extents[i].shown || !viewport.plot.Contains(boxes[i].center())) continue;
    requests.push_back({all[i].name.substr(skipped), boxes[i]});
    robots.push_back(i);
  }
  const auto text_width = [&](const std::string& text, double size) { return canvas.TextWidth(text, {size, {}}); };
  const bool crowd = requests.size() > kCrowd;
  const std::vector<double> sizes =
      crowd ? std::vector<double>{8.5 * u} : std::vector<double>{12.0 * u, 10.0 * u, 8.5 * u};
  const LabelPlan plan = PlaceLabels(requests, walls, viewport.plot, sizes, text_width);
  for (const PlacedLabel& label : plan.labels) {
    const bool stalled = drawing.state.robots[robots[label.request]].stalled;
    const Color& color = stalled ? page::kStalled : crowd ? page::kQuietText : page::kText;
    canvas.Fill(label.box.Inflated(1.5 * u), WithOpacity(page::kPaper, 0.7));
    canvas.Text(requests[label.request].text, {label.box.min_x, label.box.max_y - 0.15 * plan.size}, TextAnchor::kLeft,
                {plan.size, color});
  }
}

}  // namespace troupe
