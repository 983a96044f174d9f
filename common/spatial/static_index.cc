#include "common/spatial/static_index.h"

#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace troupe {
namespace {

constexpr double kCellsPerPiece = 8.0;
// A piece may reach over several cells; if all together do so more than this often, the cells are too small.
constexpr std::size_t kMaxEntriesPerPiece = 24;
constexpr double kMargin = 1e-7;  // m, far above the rounding of a distance along a ray

constexpr double kPixelsPerCell = 2.0;  // along each axis
constexpr double kMaxCells = 1 << 30;   // as offsets of 32 bits allow
// m, far above the rounding of a pose and of a distance along a ray.
constexpr double kReach = 1e-7;

}  // namespace

StaticIndex::StaticIndex(std::vector<ConvexPiece> pieces, std::vector<PixelPieces> areas)
    : pieces_(std::move(pieces)), areas_(std::move(areas)) {
  for (const PixelPieces& area : areas_) bounds_.Extend(area.bounds());
  if (pieces_.empty()) return;
  RayMapArrays arrays;
  arrays.pieces.reserve(pieces_.size());
  for (const ConvexPiece& piece : pieces_) {
    kept_bounds_.Extend(BoundingBox(piece.vertices));
    // Transparent pieces keep their numbers, with an empty interval of heights.
    arrays.pieces.push_back({.box = BoundingBox(piece.vertices),
                             .z = piece.ranger_return >= 0.0 ? piece.z : ZRange{0.0, 0.0},
                             .model = piece.model,
                             .is_box = IsBox(piece.vertices) ? 1u : 0u,
                             .first_vertex = static_cast<std::uint32_t>(arrays.vertices.size()),
                             .vertex_count = static_cast<std::uint32_t>(piece.vertices.size())});
    arrays.vertices.insert(arrays.vertices.end(), piece.vertices.begin(), piece.vertices.end());
  }
  bounds_.Extend(kept_bounds_);

  const Rectangle area =
      kept_bounds_.Inflated(kMargin + kWalkTolerance * std::max(kept_bounds_.width(), kept_bounds_.height()));
  const double max_cells = kCellsPerPiece * static_cast<double>(pieces_.size()) + 64.0;
  // About eight cells for each piece: walls are long and thin, and most cells of a building are empty.
  double cell_size = std::sqrt(area.width() * area.height() / max_cells);
  // Larger cells until pieces reach over few of them: a world of large blocks would else be entered into every cell.
  for (;;) {
    grid_ = Grid(area, cell_size, 2.0 * max_cells);
    const std::size_t entries =
        std::accumulate(pieces_.begin(), pieces_.end(), std::size_t{0},
                        [this](std::size_t sum, const ConvexPiece& piece) { return sum + CellsOf(piece).count(); });
    if (entries <= kMaxEntriesPerPiece * pieces_.size() + 64 || grid_.cell_count() == 1) break;
    cell_size = 1.5 * grid_.cell_size();
  }
  FillCells(arrays);
  ray_map_ = RayMap(arrays);
}

void StaticIndex::FillCells(RayMapArrays& arrays) const {
  const auto for_each_entry = [this](auto&& visit) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const CellRange range = CellsOf(pieces_[i]);
      for (std::int32_t row = range.min_row; row <= range.max_row; ++row) {
        for (std::int32_t column = range.min_column; column <= range.max_column; ++column) {
          visit(grid_.CellAt(column, row), static_cast<std::uint32_t>(i));
        }
      }
    }
  };
  // A counting sort by cell, which keeps the order of pieces: indices of a cell are ascending.
  arrays.cell_start.assign(grid_.cell_count() + 1, 0);
  for_each_entry([&](std::size_t cell, std::uint32_t) { ++arrays.cell_start[cell + 1]; });
  std::partial_sum(arrays.cell_start.begin(), arrays.cell_start.end(), arrays.cell_start.begin());
  arrays.cell_pieces.resize(arrays.cell_start.back());
  arrays.filled.assign(grid_.cell_count(), 0);
  for_each_entry([&](std::size_t cell, std::uint32_t) { arrays.filled[cell] = 1; });
  std::vector<std::uint32_t> next(arrays.cell_start.begin(), arrays.cell_start.end() - 1);
  for_each_entry([&](std::size_t cell, std::uint32_t piece) { arrays.cell_pieces[next[cell]++] = piece; });
}

CellRange StaticIndex::CellsOf(const ConvexPiece& piece) const {
  return grid_.CellsOf(BoundingBox(piece.vertices).Inflated(kMargin + kWalkTolerance * grid_.cell_size()));
}

void StaticIndex::QueryKept(const Rectangle& box, std::pmr::vector<const ConvexPiece*>& result) const {
  if (pieces_.empty() || !kept_bounds_.Overlaps(box)) return;
  const auto append_if_near = [&](std::uint32_t piece) {
    if (ray_map_.piece(piece).box.Overlaps(box)) result.push_back(&pieces_[piece]);
  };
  const CellRange range = grid_.CellsOf(box);
  // For a large box the list of pieces is shorter than that of its cells.
  if (range.count() >= pieces_.size()) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) append_if_near(static_cast<std::uint32_t>(i));
    return;
  }
  for (std::int32_t row = range.min_row; row <= range.max_row; ++row) {
    for (std::int32_t column = range.min_column; column <= range.max_column; ++column) {
      for (std::uint32_t piece : ray_map_.PiecesInCell(grid_.CellAt(column, row))) append_if_near(piece);
    }
  }
  std::sort(result.begin(), result.end());  // by number: pieces_ is one array
  result.erase(std::unique(result.begin(), result.end()), result.end());
}

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
  // Along the axes the corners of the whole bitmap are enough; turned, its box would be wider than its pieces.
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
  // Step by step as a loader would move a listed rectangle: the same operations give the same bits.
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
