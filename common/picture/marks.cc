#include <algorithm>

#include "common/picture/shading.h"
#include "common/picture/views.h"

namespace troupe {
namespace {

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
