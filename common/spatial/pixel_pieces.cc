#include "common/spatial/pixel_pieces.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace troupe {
namespace {

constexpr double kPixelsPerCell = 2.0;  // along each axis
constexpr double kMaxCells = 1 << 30;   // as offsets of 32 bits allow
// m, far above the rounding of a pose and of a distance along a ray.
constexpr double kReach = 1e-7;

}  // namespace

PixelPieces::PixelPieces(const WorldDescription& world, ModelId id, const Pose& X_WM)
    : area_(*world.shape(world.model(id).shape).area),
      X_WM_(X_WM),
      X_MA_(area_.X_MA()),
      turned_(area_.X_MA().heading != 0.0),
      model_(id),
      z_(world.shape(world.model(id).shape).rectangles_z + X_WM.z),
      obstacle_(world.model(id).obstacle_return),
      ranger_return_(world.model(id).ranger_return),
      ray_z_(ranger_return_ >= 0.0 ? z_ : ZRange{0.0, 0.0}) {
  const Rectangle area = area_.bounds();
  const double side = kPixelsPerCell * std::sqrt(area_.x().spacing() * area_.y().spacing());
  const auto pixels = static_cast<double>(area_.cover().bitmap().width()) * area_.cover().bitmap().height();
  grid_ = Grid(area.Inflated(kReach + kWalkTolerance * std::max(area.width(), area.height())), side,
               std::min(pixels + 64.0, kMaxCells));
  FillCells();
  if (!turned_ && X_WM.heading == 0.0) {
    bounds_ = BoundingBox(CornersOf(area_.cover().bounds()));
  } else {
    area_.cover().ForEach([this](const PixelRectangle& r) { bounds_.Extend(BoundingBox(CornersOf(r))); });
  }
}

void PixelPieces::FillCells() {
  filled_.assign(grid_.cell_count(), 0);
  const double margin = kReach + kWalkTolerance * grid_.cell_size();
  area_.ForEach([&](const Rectangle& r) {
    const CellRange range = grid_.CellsOf(r.Inflated(margin));
    for (std::int32_t row = range.min_row; row <= range.max_row; ++row) {
      const auto first = filled_.begin() + static_cast<std::ptrdiff_t>(grid_.CellAt(range.min_column, row));
      std::fill_n(first, range.max_column - range.min_column + 1, std::uint8_t{1});
    }
  });
}

PixelPieces::Corners4 PixelPieces::CornersOf(const PixelRectangle& r) const {
  Corners4 corners = Corners(area_.InMetres(r));
  for (Vec2& corner : corners) {
    if (turned_) corner = X_MA_ * corner;
    corner = X_WM_ * corner;
  }
  return corners;
}

ConvexPiece PixelPieces::PieceOf(const Corners4& corners) const {
  return {.vertices = {corners.begin(), corners.end()},
          .z = z_,
          .model = model_,
          .obstacle = obstacle_,
          .ranger_return = ranger_return_};
}

std::pmr::vector<PixelRectangle> PixelPieces::RectanglesIn(const Rectangle& box_W,
                                                           std::pmr::memory_resource& memory) const {
  Rectangle box = Rectangle::Nothing();
  for (const Vec2& corner : Corners(box_W)) box.Extend(InArea(corner));
  std::pmr::vector<PixelRectangle> rectangles(&memory);
  area_.cover().ForEachIn(area_.PixelsIn(box.Inflated(kReach)),
                          [&](const PixelRectangle& r) { rectangles.push_back(r); });
  std::sort(rectangles.begin(), rectangles.end(), [](const PixelRectangle& a, const PixelRectangle& b) {
    return std::tie(a.y0, a.x0) < std::tie(b.y0, b.x0);
  });
  return rectangles;
}

void AppendAreaPieces(const WorldDescription& world, ModelId id, const Pose& X_WM, std::vector<PixelPieces>& areas) {
  const Shape& shape = world.shape(world.model(id).shape);
  if (shape.area && HasHeight(shape.rectangles_z)) areas.emplace_back(world, id, X_WM);
}

PixelRectangle PixelPieces::PixelsOf(std::size_t cell) const {
  const auto columns = static_cast<std::size_t>(grid_.axis(0).count);
  const double size = grid_.cell_size();
  const std::size_t row = cell / columns;
  const double x = grid_.axis(0).low + static_cast<double>(cell % columns) * size;
  const double y = grid_.axis(1).low + static_cast<double>(row) * size;
  return area_.PixelsIn(Rectangle{x, y, x + size, y + size}.Inflated(kReach + kWalkTolerance * size));
}

}  // namespace troupe
