#include "common/spatial/column_cast.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "common/spatial/convex_piece.h"

namespace troupe {
namespace {

// The part of a ray within a convex polygon, in m along the ray; nothing if it passes by, or the polygon is behind it.
// The side of a vertex depends on the vertex and the ray alone, so that no ray slips between two polygons that share
// one.
struct Stretch {
  double enter;
  double leave;
  Vec2 edge;  // by which it enters, counter-clockwise
};

std::optional<Stretch> StretchWithin(std::span<const Vec2> vertices, const Vec2& origin, const Vec2& direction) {
  double enter = std::numeric_limits<double>::infinity();
  double leave = -enter;
  Vec2 entered(0.0, 0.0);
  Vec2 before = vertices.back() - origin;
  double side_before = Cross(direction, before);
  for (const Vec2& vertex : vertices) {
    const Vec2 here = vertex - origin;
    const double side = Cross(direction, here);
    const auto add = [&](double at) {
      if (at < enter) {
        enter = at;
        entered = here - before;
      }
      leave = std::max(leave, at);
    };
    if (side == 0.0) {
      add(direction.dot(here));
    } else if ((side < 0.0 && side_before > 0.0) || (side > 0.0 && side_before < 0.0)) {
      const double at_before = direction.dot(before);
      add(at_before + (direction.dot(here) - at_before) * (side_before / (side_before - side)));
    }
    before = here;
    side_before = side;
  }
  if (!(leave > kTouchTolerance)) return std::nullopt;
  return Stretch{std::max(enter, 0.0), leave, entered};
}

ColumnCut CutOf(const Stretch& stretch, const ZRange& z, ModelId model) {
  // The outside of a counter-clockwise edge is to its right.
  const double length = stretch.edge.norm();
  const Vec2 normal = length > 0.0 ? Vec2(stretch.edge.y() / length, -stretch.edge.x() / length) : Vec2(0.0, 0.0);
  return {stretch.enter, stretch.leave, z, model, normal};
}

// Touching counts, unlike for bodies (ZRange::Overlaps): a ray that grazes a top is to see it.
bool OverlapsHeights(const ZRange& a, const ZRange& b) {
  return a.min <= b.max && b.min <= a.max;
}

bool Sees(Sight sight, double ranger_return) {
  return sight == Sight::kBodies || ranger_return >= 0.0;
}

// A half plane, and the list of its cuts.
struct Column {
  Vec2 origin;
  Vec2 direction;
  double reach;
  ZRange z;
  Sight sight;
  std::vector<ColumnCut>& cuts;

  void Add(std::span<const Vec2> vertices, const ZRange& heights, ModelId model) {
    const std::optional<Stretch> stretch = StretchWithin(vertices, origin, direction);
    if (stretch && stretch->enter <= reach) cuts.push_back(CutOf(*stretch, heights, model));
  }
  // `center`: relative to the origin.
  bool MayCutDisc(const Vec2& center, double radius) const {
    const double along = direction.dot(center);
    return std::abs(Cross(direction, center)) <= radius && along >= -radius && along - radius <= reach;
  }
};

// `is_new(i)`: false for a piece that was tested already.
template <typename IsNew>
void CutStaticPieces(const StaticIndex& index, IsNew is_new, Column& column) {
  const Eigen::Array2d inverse = column.direction.array().inverse();
  index.WalkRay(column.origin, column.direction, inverse, column.reach,
                [&](std::span<const std::uint32_t> pieces, double /*walked*/) {
                  for (const std::uint32_t i : pieces) {
                    if (!is_new(i)) continue;
                    const ConvexPiece& piece = index.kept_pieces()[i];
                    if (!Sees(column.sight, piece.ranger_return) || !HasHeight(piece.z)) continue;
                    if (OverlapsHeights(piece.z, column.z)) column.Add(piece.vertices, piece.z, piece.model);
                  }
                  return true;
                });
  for (const PixelPieces& area : index.areas()) {
    if (!Sees(column.sight, area.ranger_return()) || !OverlapsHeights(area.z(), column.z)) continue;
    area.WalkRay(column.origin, column.direction, column.reach, [&](const PixelRectangle& pixels, double /*walked*/) {
      area.ForEachIn(pixels,
                     [&](const PixelPieces::Corners4& corners) { column.Add(corners, area.z(), area.model()); });
      return true;
    });
  }
}

void SortCuts(std::vector<ColumnCut>& cuts) {
  // A total order: the cells of an index, in whose order the pieces are found, do not matter.
  std::sort(cuts.begin(), cuts.end(), [](const ColumnCut& a, const ColumnCut& b) {
    return std::tie(a.enter, a.model, a.leave, a.z.min, a.z.max) <
           std::tie(b.enter, b.model, b.leave, b.z.min, b.z.max);
  });
  // A piece may have been found in several cells.
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
}

}  // namespace

ColumnCaster::ColumnCaster(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, double reach,
                           std::optional<RobotId> viewer, Sight sight)
    : scene_(scene), bodies_(bodies), origin_(origin), reach_(reach), sight_(sight) {
  tested_.resize(scene.static_index().kept_pieces().size(), 0);
  bodies.ForEachNear(Rectangle::Around(origin, reach), [&](BodyId id) {
    if (viewer && bodies.owner(id) == viewer) return;
    // A vertex that was moved to W may be farther than the radius by its rounding.
    const double radius = scene.body(id).radius * (1.0 + 1e-9) + 1e-9;
    near_.push_back({id, {bodies.X_WB(id).translation() - origin_, radius}, std::nullopt});
  });
}

std::span<const ColumnCaster::NearPiece> ColumnCaster::PiecesOf(NearBody& near) {
  if (!near.first_piece) {
    near.first_piece = pieces_.size();
    for (const ConvexPiece& piece : bodies_.pieces_in_world(near.id)) {
      if (!Sees(sight_, piece.ranger_return) || !HasHeight(piece.z)) continue;
      const Vec2 center = BoundingBox(piece.vertices).center();
      double radius = 0.0;
      for (const Vec2& vertex : piece.vertices) radius = std::max(radius, (vertex - center).norm());
      pieces_.push_back({{center - origin_, radius * (1.0 + 1e-9) + 1e-9}, &piece});
    }
    near.piece_count = pieces_.size() - *near.first_piece;
  }
  return std::span(pieces_).subspan(*near.first_piece, near.piece_count);
}

void ColumnCaster::Cut(const Vec2& direction, const ZRange& z, double length, std::vector<ColumnCut>& cuts) {
  cuts.clear();
  Column column{origin_, direction, length, z, sight_, cuts};
  ++number_;
  const auto is_new = [&](std::uint32_t piece) { return std::exchange(tested_[piece], number_) != number_; };
  CutStaticPieces(scene_.static_index(), is_new, column);
  for (NearBody& body : near_) {
    if (!column.MayCutDisc(body.disc.center, body.disc.radius)) continue;
    for (const NearPiece& near : PiecesOf(body)) {
      if (!column.MayCutDisc(near.disc.center, near.disc.radius) || !OverlapsHeights(near.piece->z, z)) continue;
      column.Add(near.piece->vertices, near.piece->z, near.piece->model);
    }
  }
  SortCuts(cuts);
}

std::optional<ColumnHit> FirstHit(const ClimbingRay& ray, std::span<const ColumnCut> cuts) {
  std::optional<CutHit> first;
  const ColumnCut* first_cut = nullptr;
  for (const ColumnCut& cut : cuts) {
    // Cuts are in the order of `enter`: none of the others can be hit before.
    if (first && cut.enter > first->distance) break;
    const std::optional<CutHit> hit = HitOf(ray, cut);
    if (!hit) continue;
    if (first && std::tie(first->distance, first_cut->model) <= std::tie(hit->distance, cut.model)) continue;
    first = hit;
    first_cut = &cut;
  }
  if (!first) return std::nullopt;
  const bool is_side = first->face == PrismFace::kSide || first->face == PrismFace::kInside;
  return ColumnHit{first->distance, first_cut->model, first->face, is_side ? first_cut->normal : Vec2(0.0, 0.0)};
}

}  // namespace troupe
