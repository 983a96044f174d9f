#include "common/picture/labels.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "common/picture/canvas.h"
#include "common/picture/views.h"

namespace troupe {
namespace {

// The places of a label of this size around a box, best first.
std::array<Rectangle, 8> Candidates(const Rectangle& box, double width, double height) {
  const double gap = 0.35 * height;
  const Vec2 c = box.center();
  const auto at = [&](double x, double y) { return Rectangle{x, y, x + width, y + height}; };
  const double left = box.min_x - gap - width, right = box.max_x + gap;
  const double above = box.min_y - 0.5 * gap - height, below = box.max_y + 0.5 * gap;
  const double mid_x = c.x() - 0.5 * width, mid_y = c.y() - 0.5 * height;
  return {at(right, mid_y), at(left, mid_y),  at(mid_x, above), at(mid_x, below),
          at(right, above), at(right, below), at(left, above),  at(left, below)};
}

bool OverlapsAny(const Rectangle& box, const std::vector<Rectangle>& others) {
  return std::any_of(others.begin(), others.end(), [&](const Rectangle& other) { return box.Overlaps(other); });
}

std::vector<Rectangle> Overlapping(const std::vector<Rectangle>& boxes, const Rectangle& area) {
  std::vector<Rectangle> result;
  std::copy_if(boxes.begin(), boxes.end(), std::back_inserter(result),
               [&](const Rectangle& box) { return box.Overlaps(area); });
  return result;
}

std::vector<PlacedLabel> PlaceAtSize(const std::vector<LabelRequest>& requests, const std::vector<Rectangle>& walls,
                                     const Rectangle& page, double size,
                                     const std::function<double(const std::string&, double)>& text_width) {
  std::vector<Rectangle> occupied;
  for (const LabelRequest& request : requests) occupied.push_back(request.box);
  std::vector<PlacedLabel> result;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto candidates = Candidates(requests[i].box, text_width(requests[i].text, size), size);
    Rectangle around = Rectangle::Nothing();
    for (const Rectangle& box : candidates) around.Extend(box);
    const std::vector<Rectangle> walls_around = Overlapping(walls, around);
    const auto place = [&](bool over_walls) {
      for (const Rectangle& box : candidates) {
        const bool inside = page.Contains({box.min_x, box.min_y}) && page.Contains({box.max_x, box.max_y});
        if (!inside || OverlapsAny(box, occupied) || (!over_walls && OverlapsAny(box, walls_around))) continue;
        occupied.push_back(box);
        result.push_back({i, box});
        return true;
      }
      return false;
    };
    // A name on a wall is better than none; a name over another robot is not.
    if (!place(false)) place(true);
  }
  return result;
}

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

struct MarkStyle {
  Color color;
  double width;  // units
};

MarkStyle StyleOf(MarkRole role) {
  switch (role) {
    case MarkRole::kReach:
      return {WithOpacity(page::kScan, 0.5), 0.8};
    case MarkRole::kFound:
      return {{0.18, 0.55, 0.24, 0.95}, 1.6};
    case MarkRole::kIdle:
      return {{0.45, 0.49, 0.55, 0.9}, 1.8};
    case MarkRole::kTouched:
      return {page::kStalled, 2.6};
  }
  return {};
}

Vec2 OnPage(const Viewport& viewport, PictureView view, const Mark& mark, const Vec2& point) {
  return view == PictureView::kTop ? viewport.ToPage(point) : viewport.ToPage(point.x(), mark.z);
}

}  // namespace

LabelPlan PlaceLabels(const std::vector<LabelRequest>& requests, const std::vector<Rectangle>& walls,
                      const Rectangle& page, const std::vector<double>& sizes,
                      const std::function<double(const std::string&, double)>& text_width) {
  LabelPlan plan;
  for (double size : sizes) {
    plan = {size, PlaceAtSize(requests, walls, page, size, text_width)};
    if (plan.labels.size() == requests.size()) return plan;
  }
  if (2 * plan.labels.size() < requests.size()) plan.labels.clear();
  return plan;
}

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

void DrawMarks(Canvas& canvas, const Viewport& viewport, const Drawing& drawing, PictureView view, MarkShape shape) {
  const double u = viewport.unit;
  for (const Mark& mark : drawing.marks) {
    if (mark.shape != shape) continue;
    const MarkStyle style = StyleOf(mark.role);
    std::vector<Vec2> points;
    for (const Vec2& point : mark.points) points.push_back(OnPage(viewport, view, mark, point));
    switch (shape) {
      case MarkShape::kArea:
        if (view == PictureView::kSide) break;  // seen from its edge
        canvas.Fill(std::vector<Polygon>{points}, WithOpacity(style.color, 0.10));
        canvas.Stroke(std::vector<Polygon>{points}, style.width * u, WithOpacity(style.color, 0.35));
        break;
      case MarkShape::kLine:
        for (std::size_t i = 1; i < points.size(); ++i) {
          canvas.Line(points[i - 1], points[i], style.width * u, style.color);
        }
        break;
      case MarkShape::kDot:
        for (const Vec2& point : points) {
          canvas.FillCircle(point, 3.6 * u, {1.0, 1.0, 1.0, 0.9});
          canvas.FillCircle(point, 2.6 * u, style.color);
        }
        break;
    }
  }
}

}  // namespace troupe
