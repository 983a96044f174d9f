#include "common/picture/rectangle_outline.h"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace troupe {
namespace {

// Distinct coordinates in order, so that edges can be compared as integers.
class Coordinates {
 public:
  Coordinates(std::vector<double> values, double tolerance) {
    std::sort(values.begin(), values.end());
    for (double value : values) {
      if (values_.empty() || value - values_.back() > tolerance) values_.push_back(value);
    }
  }
  std::int64_t IndexOf(double value) const {
    const auto after = std::upper_bound(values_.begin(), values_.end(), value);
    return std::max<std::int64_t>(0, after - values_.begin() - 1);
  }
  double operator[](std::int64_t index) const { return values_[static_cast<std::size_t>(index)]; }

 private:
  std::vector<double> values_;
};

struct Edge {
  std::int64_t line;  // the coordinate that both ends share
  std::int64_t from;
  std::int64_t to;
  auto operator<=>(const Edge&) const = default;
};

// The parts of edges on common lines that are on the outline: where two coincide, neither is.
std::vector<Edge> CancelPairs(const std::vector<Edge>& edges) {
  struct End {
    std::int64_t line;
    std::int64_t at;
    auto operator<=>(const End&) const = default;
  };
  std::vector<End> ends;
  for (const Edge& edge : edges) {
    ends.push_back({edge.line, edge.from});
    ends.push_back({edge.line, edge.to});
  }
  std::sort(ends.begin(), ends.end());
  // Along each line, inside and outside the outline's edges alternate at the ends that occur an odd number of times.
  std::vector<End> turns;
  for (const End& end : ends) {
    if (!turns.empty() && turns.back() == end) {
      turns.pop_back();
    } else {
      turns.push_back(end);
    }
  }
  std::vector<Edge> result;
  for (std::size_t i = 0; i + 1 < turns.size(); i += 2) {
    result.push_back({turns[i].line, turns[i].at, turns[i + 1].at});
  }
  return result;
}

struct Corner {
  std::int64_t x;
  std::int64_t y;
  auto operator<=>(const Corner&) const = default;
};

// Edges by the corners at their ends, each to be used once.
class EdgesAtCorners {
 public:
  void Add(const Corner& a, const Corner& b) {
    ends_.push_back({a, b, used_.size()});
    ends_.push_back({b, a, used_.size()});
    used_.push_back(false);
  }
  void Sort() { std::sort(ends_.begin(), ends_.end()); }

  // Marks an unused edge at `corner` as used, and returns its other end; nothing if there is none.
  std::optional<Corner> UseEdge(const Corner& corner) {
    auto end = std::lower_bound(ends_.begin(), ends_.end(), End{corner, {0, 0}, 0},
                                [](const End& a, const End& b) { return a.here < b.here; });
    for (; end != ends_.end() && end->here == corner; ++end) {
      if (used_[end->edge]) continue;
      used_[end->edge] = true;
      return end->there;
    }
    return std::nullopt;
  }

 private:
  struct End {
    Corner here;
    Corner there;
    std::size_t edge;
    auto operator<=>(const End&) const = default;
  };
  std::vector<End> ends_;
  std::vector<bool> used_;
};

}  // namespace

std::vector<Polygon> OutlineOf(const std::vector<Rectangle>& rectangles) {
  if (rectangles.empty()) return {};
  Rectangle bounds = Rectangle::Nothing();
  std::vector<double> all_x;
  std::vector<double> all_y;
  for (const Rectangle& r : rectangles) {
    bounds.Extend(r);
    all_x.insert(all_x.end(), {r.min_x, r.max_x});
    all_y.insert(all_y.end(), {r.min_y, r.max_y});
  }
  const double tolerance = 1e-9 * std::max(bounds.width(), bounds.height());
  const Coordinates xs(std::move(all_x), tolerance);
  const Coordinates ys(std::move(all_y), tolerance);

  std::vector<Edge> vertical;
  std::vector<Edge> horizontal;
  for (const Rectangle& r : rectangles) {
    const std::int64_t x0 = xs.IndexOf(r.min_x), x1 = xs.IndexOf(r.max_x);
    const std::int64_t y0 = ys.IndexOf(r.min_y), y1 = ys.IndexOf(r.max_y);
    if (x0 == x1 || y0 == y1) continue;
    vertical.push_back({x0, y0, y1});
    vertical.push_back({x1, y0, y1});
    horizontal.push_back({y0, x0, x1});
    horizontal.push_back({y1, x0, x1});
  }
  vertical = CancelPairs(vertical);
  horizontal = CancelPairs(horizontal);

  // Corners join one vertical with one horizontal edge; where two areas touch at a corner, two of each meet, and any
  // pairing outlines the same area.
  EdgesAtCorners verticals;
  EdgesAtCorners horizontals;
  for (const Edge& edge : vertical) verticals.Add({edge.line, edge.from}, {edge.line, edge.to});
  for (const Edge& edge : horizontal) horizontals.Add({edge.from, edge.line}, {edge.to, edge.line});
  verticals.Sort();
  horizontals.Sort();

  std::vector<Polygon> loops;
  for (const Edge& first : vertical) {
    Polygon loop;
    std::optional<Corner> at = Corner{first.line, first.from};
    while (const std::optional<Corner> next = verticals.UseEdge(*at)) {
      loop.emplace_back(xs[at->x], ys[at->y]);
      loop.emplace_back(xs[next->x], ys[next->y]);
      at = horizontals.UseEdge(*next);
      if (!at) break;
    }
    if (!loop.empty()) loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace troupe
