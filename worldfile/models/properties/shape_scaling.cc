#include "worldfile/models/properties/shape_scaling.h"

#include <algorithm>
#include <limits>

namespace troupe {
namespace {

// The map of one axis: stretched about `center`, which moves to 0.
struct AxisMap {
  double center = 0.0;
  double factor = 1.0;
  double operator()(double value) const { return (value - center) * factor; }
};

AxisMap FitAxis(double min, double max, double size) {
  if (!(max > min)) return {};
  return {0.5 * (min + max), size / (max - min)};
}

}  // namespace

Shape ScaledToSize(Shape shape, const Size& size) {
  Rectangle bounds = Rectangle::Nothing();
  ZRange height{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const auto extend_height = [&height](const ZRange& z) {
    height.min = std::min(height.min, z.min);
    height.max = std::max(height.max, z.max);
  };
  for (const Block& block : shape.blocks) {
    bounds.Extend(BoundingBox(block.outline));
    extend_height(block.z);
  }
  for (const Rectangle& rectangle : shape.rectangles) bounds.Extend(rectangle);
  if (shape.area) bounds.Extend(shape.area->bounds());
  if (!shape.rectangles.empty() || shape.area) extend_height(shape.rectangles_z);
  if (bounds.empty()) return shape;

  const AxisMap x = FitAxis(bounds.min_x, bounds.max_x, size.x);
  const AxisMap y = FitAxis(bounds.min_y, bounds.max_y, size.y);
  const double z = height.max > height.min ? size.z / (height.max - height.min) : 1.0;
  for (Block& block : shape.blocks) {
    for (Vec2& vertex : block.outline) vertex = {x(vertex.x()), y(vertex.y())};
    block.z = {block.z.min * z, block.z.max * z};
  }
  for (Rectangle& r : shape.rectangles) r = {x(r.min_x), y(r.min_y), x(r.max_x), y(r.max_y)};
  if (shape.area) shape.area = shape.area->Stretched({x.center, y.center}, {x.factor, y.factor});
  shape.rectangles_z = {shape.rectangles_z.min * z, shape.rectangles_z.max * z};
  return shape;
}

Shape Moved(Shape shape, const Pose& X_MD) {
  if (X_MD.heading != 0.0 && !shape.area) {
    for (const Rectangle& rectangle : shape.rectangles) shape.blocks.push_back(BoxBlock(rectangle, shape.rectangles_z));
    shape.rectangles.clear();
    shape.rectangles_z = {};
  }
  const Transform2 move(X_MD);
  for (Block& block : shape.blocks) {
    for (Vec2& vertex : block.outline) vertex = move * vertex;
    block.z = block.z + X_MD.z;
  }
  for (Rectangle& r : shape.rectangles) {
    r = {r.min_x + X_MD.x, r.min_y + X_MD.y, r.max_x + X_MD.x, r.max_y + X_MD.y};
  }
  if (shape.area) shape.area = shape.area->Moved(X_MD);
  if (!shape.rectangles.empty() || shape.area) shape.rectangles_z = shape.rectangles_z + X_MD.z;
  return shape;
}

Block BoxBlock(const Rectangle& area, const ZRange& z) {
  const std::array<Vec2, 4> corners = Corners(area);
  return {Polygon(corners.begin(), corners.end()), z};
}

}  // namespace troupe
