// Meshes of the static world as blocks. A mesh of a building is mostly one of many: boxes that touch nothing, and
// walls of one piece around rooms. The former are exact as hulls; the latter are drawn into a grid, band by band.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "troupe/bitmap.h"
#include "troupe/rectangle_cover.h"
#include "worldfile/gazebo/solid.h"

namespace troupe {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

constexpr double kWeld = 1e-5;                 // m: corners nearer than this are one
constexpr double kConvexTolerance = 2e-3;      // m, of a corner beyond the plane of a face
constexpr double kCell = 0.02;                 // m, of the grid
constexpr int kMaxSide = 3000;                 // cells
constexpr std::size_t kMaxRectangles = 6'000;  // of one mesh; with more the cells are larger
constexpr std::size_t kMaxBands = 8;
constexpr double kSameLevel = 0.02;               // m, between two heights that limit bands
constexpr double kSliver = 2e-3;                  // m: what reaches less far into a band is not in it
constexpr std::size_t kMaxHullTriangles = 5'000;  // of a part that is cut into hulls, which costs a look at all of them
constexpr std::size_t kMaxParts = 20'000;

// The mesh with each corner once.
TriangleMesh Welded(const TriangleMesh& mesh) {
  TriangleMesh welded;
  std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t>, std::uint32_t> known;
  std::vector<std::uint32_t> index(mesh.points.size());
  const auto cell = [](double value) { return static_cast<std::int64_t>(std::llround(value / kWeld)); };
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3& p = mesh.points[i];
    const auto [entry, is_new] =
        known.emplace(std::tuple{cell(p.x), cell(p.y), cell(p.z)}, static_cast<std::uint32_t>(welded.points.size()));
    if (is_new) welded.points.push_back(p);
    index[i] = entry->second;
  }
  for (const auto& t : mesh.triangles) {
    const std::array<std::uint32_t, 3> corners = {index[t[0]], index[t[1]], index[t[2]]};
    const bool is_line = corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
    if (!is_line) welded.triangles.push_back(corners);
  }
  return welded;
}

// The triangles of each connected part, in the order of their first ones.
std::vector<Triangles> PartsOf(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> root(mesh.points.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&root](std::uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 1; k < 3; ++k) {
      const std::uint32_t a = find(t[0]);
      const std::uint32_t b = find(t[k]);
      root[std::max(a, b)] = std::min(a, b);
    }
  }
  std::map<std::uint32_t, std::size_t> number;
  std::vector<Triangles> parts;
  for (const auto& t : mesh.triangles) {
    const auto [entry, is_new] = number.emplace(find(t[0]), parts.size());
    if (is_new) parts.emplace_back();
    parts[entry->second].push_back(t);
  }
  return parts;
}

// Whether each edge has two triangles that go along it in opposite directions.
bool IsClosed(const Triangles& triangles) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (i > 0 && edges[i] == edges[i - 1]) return false;
    if (!std::binary_search(edges.begin(), edges.end(), std::pair{edges[i].second, edges[i].first})) return false;
  }
  return true;
}

// m^3; negative if the triangles face inwards.
double VolumeOf(const std::vector<Vec3>& points, const Triangles& triangles) {
  const Vec3& origin = points[triangles.front()[0]];
  double volume = 0.0;
  for (const auto& t : triangles) {
    volume += Dot(points[t[0]] - origin, Cross(points[t[1]] - origin, points[t[2]] - origin)) / 6.0;
  }
  return volume;
}

// REQUIRES: closed, facing outwards.
bool IsConvex(const std::vector<Vec3>& points, const Triangles& triangles) {
  std::vector<std::uint32_t> corners;
  for (const auto& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  // A solid of many corners is treated as concave, which costs accuracy and no correctness.
  if (corners.size() * triangles.size() > 2'000'000) return false;
  for (const auto& t : triangles) {
    const Vec3 normal = Cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
    const double length = Length(normal);
    if (!(length > 0.0)) continue;
    for (const std::uint32_t corner : corners) {
      if (Dot(points[corner] - points[t[0]], normal) > kConvexTolerance * length) return false;
    }
  }
  return true;
}

ZRange HeightsOf(const std::vector<Vec3>& points, const Triangles& triangles) {
  ZRange z{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const auto& t : triangles) {
    for (const std::uint32_t corner : t) z = {std::min(z.min, points[corner].z), std::max(z.max, points[corner].z)};
  }
  return z;
}

void Append(SolidBlocks more, SolidBlocks& made) {
  std::move(more.blocks.begin(), more.blocks.end(), std::back_inserter(made.blocks));
  made.error = std::max(made.error, more.error);
  made.is_hollow = made.is_hollow || more.is_hollow;
}

struct GridPart {
  Triangles triangles;
  bool is_solid = false;
};

// Draws parts into a grid, one band of heights after another.
class BandGrid {
 public:
  BandGrid(const std::vector<Vec3>& points, const std::vector<GridPart>& parts) : points_(points), parts_(parts) {
    for (const GridPart& part : parts) {
      for (const auto& t : part.triangles) {
        for (const std::uint32_t corner : t) area_.Extend(Vec2(points[corner].x, points[corner].y));
      }
    }
  }

  SolidBlocks Make() const {
    const std::vector<double> levels = Levels();
    double cell = std::max({kCell, area_.width() / kMaxSide, area_.height() / kMaxSide});
    // Larger cells until the rectangles are few enough.
    for (;; cell *= 2.0) {
      if (std::optional<SolidBlocks> made = Draw(levels, cell)) {
        made->error = cell;
        return std::move(*made);
      }
    }
  }

 private:
  // The heights at which the most corners are, with the lowest and the highest.
  std::vector<double> Levels() const {
    std::vector<double> heights;
    for (const GridPart& part : parts_) {
      for (const auto& t : part.triangles) {
        for (const std::uint32_t corner : t) heights.push_back(points_[corner].z);
      }
    }
    std::sort(heights.begin(), heights.end());
    std::vector<std::pair<std::size_t, double>> counted;  // corners, height
    for (std::size_t begin = 0; begin < heights.size();) {
      std::size_t end = begin;
      while (end < heights.size() && heights[end] - heights[begin] <= kSameLevel) ++end;
      counted.emplace_back(end - begin, heights[begin]);
      begin = end;
    }
    std::sort(counted.begin(), counted.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    counted.resize(std::min(counted.size(), kMaxBands - 1));
    std::vector<double> levels = {heights.front(), heights.back()};
    for (const auto& [count, height] : counted) levels.push_back(height);
    std::sort(levels.begin(), levels.end());
    std::vector<double> apart;
    for (const double level : levels) {
      if (apart.empty() || level - apart.back() > kSameLevel) apart.push_back(level);
    }
    // The highest is the top, even if it is near the one below.
    if (apart.size() > 1)
      apart.back() = std::max(apart.back(), heights.back());
    else if (heights.back() - heights.front() > kSliver)
      apart.push_back(heights.back());
    return apart;
  }

  // Nothing if there are too many rectangles.
  std::optional<SolidBlocks> Draw(const std::vector<double>& levels, double cell) const {
    const int width = static_cast<int>(std::ceil(area_.width() / cell)) + 1;
    const int height = static_cast<int>(std::ceil(area_.height() / cell)) + 1;
    SolidBlocks made;
    std::optional<Bitmap> below;
    double below_from = 0.0;
    const auto finish = [&](double top) {
      const auto rectangles = CoverByRectangles(*below, kMaxRectangles);
      if (!rectangles || made.blocks.size() + rectangles->size() > kMaxRectangles) return false;
      for (const PixelRectangle& r : *rectangles) {
        const double x0 = area_.min_x + r.x0 * cell;
        const double x1 = area_.min_x + r.x1 * cell;
        const double y0 = area_.min_y + r.y0 * cell;
        const double y1 = area_.min_y + r.y1 * cell;
        made.blocks.push_back({{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {below_from, top}});
      }
      return true;
    };
    for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
      Bitmap band(width, height);
      for (const GridPart& part : parts_) {
        for (const auto& t : part.triangles) DrawTriangle(t, levels[i], levels[i + 1], cell, band);
        if (part.is_solid) Fill(part.triangles, 0.5 * (levels[i] + levels[i + 1]), cell, band);
      }
      // Equal bands, as of walls, are one.
      if (below && *below == band) continue;
      if (below && !finish(levels[i])) return std::nullopt;
      below = std::move(band);
      below_from = levels[i];
    }
    if (below && !finish(levels.back())) return std::nullopt;
    return made;
  }

  // All cells that the part of the triangle in a band touches.
  void DrawTriangle(const std::array<std::uint32_t, 3>& t, double low, double high, double cell, Bitmap& band) const {
    const double from = low + kSliver;
    const double to = high - kSliver;
    std::vector<Vec3> polygon = {points_[t[0]], points_[t[1]], points_[t[2]]};
    polygon = Clipped(polygon, [&](const Vec3& p) { return p.z - from; });
    polygon = Clipped(polygon, [&](const Vec3& p) { return to - p.z; });
    if (polygon.empty()) return;
    double min_y = std::numeric_limits<double>::infinity();
    double max_y = -min_y;
    for (const Vec3& p : polygon) {
      min_y = std::min(min_y, p.y);
      max_y = std::max(max_y, p.y);
    }
    const int first = std::max(0, RowOf(min_y, cell));
    const int last = std::min(RowOf(max_y, cell), band.height() - 1);
    for (int row = first; row <= last; ++row) {
      const double y0 = area_.min_y + row * cell;
      double min_x = std::numeric_limits<double>::infinity();
      double max_x = -min_x;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        ExtendByEdge(polygon[i], polygon[(i + 1) % polygon.size()], y0, y0 + cell, min_x, max_x);
      }
      if (min_x > max_x) continue;
      const int end = std::min(ColumnOf(max_x, cell), band.width() - 1);
      for (int column = std::max(0, ColumnOf(min_x, cell)); column <= end; ++column) {
        band.set_occupied(column, row, true);
      }
    }
  }

  int RowOf(double y, double cell) const { return static_cast<int>(std::floor((y - area_.min_y) / cell)); }
  int ColumnOf(double x, double cell) const { return static_cast<int>(std::floor((x - area_.min_x) / cell)); }

  // The part of a polygon where `side` is at least 0.
  template <typename Side>
  static std::vector<Vec3> Clipped(const std::vector<Vec3>& polygon, const Side& side) {
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3& p = polygon[i];
      const Vec3& q = polygon[(i + 1) % polygon.size()];
      const double at_p = side(p);
      const double at_q = side(q);
      if (at_p >= 0.0) kept.push_back(p);
      if ((at_p >= 0.0) != (at_q >= 0.0)) kept.push_back(p + (q - p) * (at_p / (at_p - at_q)));
    }
    return kept;
  }

  // The range of x of an edge between two y.
  static void ExtendByEdge(const Vec3& p, const Vec3& q, double y0, double y1, double& min_x, double& max_x) {
    const Vec3& a = p.y <= q.y ? p : q;
    const Vec3& b = p.y <= q.y ? q : p;
    if (a.y > y1 || b.y < y0) return;
    const auto extend = [&](double x) {
      min_x = std::min(min_x, x);
      max_x = std::max(max_x, x);
    };
    const auto at = [&](double y) { return b.y > a.y ? a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x) : a.x; };
    extend(a.y >= y0 ? a.x : at(y0));
    extend(b.y <= y1 ? b.x : at(y1));
  }

  // The cells whose middles are inside at a height: between an odd and an even crossing of the surface.
  void Fill(const Triangles& triangles, double z, double cell, Bitmap& band) const {
    std::vector<std::vector<double>> crossings(static_cast<std::size_t>(band.height()));  // x, by row
    for (const auto& t : triangles) {
      std::vector<Vec2> ends;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& p = points_[t[k]];
        const Vec3& q = points_[t[(k + 1) % 3]];
        if ((p.z >= z) == (q.z >= z)) continue;
        const double s = (z - p.z) / (q.z - p.z);
        ends.emplace_back(p.x + s * (q.x - p.x), p.y + s * (q.y - p.y));
      }
      if (ends.size() != 2 || ends[0].y() == ends[1].y()) continue;
      const Vec2& a = ends[0].y() < ends[1].y() ? ends[0] : ends[1];
      const Vec2& b = ends[0].y() < ends[1].y() ? ends[1] : ends[0];
      for (int row = std::max(0, RowOf(a.y() - 0.5 * cell, cell)); row < band.height(); ++row) {
        const double y = area_.min_y + (row + 0.5) * cell;
        if (y >= b.y()) break;
        if (y < a.y()) continue;
        crossings[static_cast<std::size_t>(row)].push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
    }
    for (int row = 0; row < band.height(); ++row) {
      std::vector<double>& xs = crossings[static_cast<std::size_t>(row)];
      std::sort(xs.begin(), xs.end());
      for (std::size_t i = 0; i + 1 < xs.size(); i += 2) {
        const int end = std::min(ColumnOf(xs[i + 1], cell), band.width() - 1);
        for (int column = std::max(0, ColumnOf(xs[i], cell)); column <= end; ++column) {
          band.set_occupied(column, row, true);
        }
      }
    }
  }

  const std::vector<Vec3>& points_;
  const std::vector<GridPart>& parts_;
  Rectangle area_ = Rectangle::Nothing();
};

}  // namespace

SolidBlocks MeshBlocks(const TriangleMesh& mesh, SolidUse use) {
  const TriangleMesh welded = Welded(mesh);
  SolidBlocks made;
  if (welded.triangles.empty()) return made;
  std::vector<Triangles> parts = PartsOf(welded);
  if (use == SolidUse::kMoving) {
    // Few blocks: the hull of the whole.
    SolidBlocks hulls = HullsInBands(welded.points, welded.triangles, use);
    return hulls;
  }
  std::vector<GridPart> for_grid;
  for (Triangles& part : parts) {
    const ZRange z = HeightsOf(welded.points, part);
    if (!(z.max - z.min > kSliver)) continue;  // a floor or a ceiling
    const bool is_solid = IsClosed(part) && VolumeOf(welded.points, part) > 0.0;
    const bool is_hull =
        is_solid && parts.size() <= kMaxParts && part.size() <= kMaxHullTriangles && IsConvex(welded.points, part);
    if (is_hull) {
      Append(HullsInBands(welded.points, part, use), made);
    } else {
      made.is_hollow = made.is_hollow || !is_solid;
      for_grid.push_back({std::move(part), is_solid});
    }
  }
  if (!for_grid.empty()) Append(BandGrid(welded.points, for_grid).Make(), made);
  return made;
}

}  // namespace troupe
