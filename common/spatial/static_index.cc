#include "common/spatial/static_index.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace troupe {
namespace {

constexpr double kCellsPerPiece = 8.0;
// A piece may reach over several cells; if all together do so more than this often, the cells are too small.
constexpr std::size_t kMaxEntriesPerPiece = 24;
constexpr double kMargin = 1e-7;  // m, far above the rounding of a distance along a ray

}  // namespace

StaticIndex::StaticIndex(std::vector<ConvexPiece> pieces, std::vector<PixelPieces> areas)
    : pieces_(std::move(pieces)), areas_(std::move(areas)) {
  for (const PixelPieces& area : areas_) bounds_.Extend(area.bounds());
  if (pieces_.empty()) return;
  RayMapArrays arrays;
  arrays.pieces.reserve(pieces_.size());
  for (const ConvexPiece& piece : pieces_) {
    kept_bounds_.Extend(BoundingBox(piece.vertices));
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
  double cell_size = std::sqrt(area.width() * area.height() / max_cells);
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

}  // namespace troupe
