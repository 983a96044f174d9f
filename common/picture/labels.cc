#include "common/picture/labels.h"

#include <algorithm>
#include <array>
#include <iterator>

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
    if (!place(false)) place(true);
  }
  return result;
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

}  // namespace troupe
