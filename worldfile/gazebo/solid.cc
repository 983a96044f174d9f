#include "worldfile/gazebo/solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/point_distance.h"
namespace troupe {
namespace {

constexpr int kRoundSides = 32;
constexpr int kRings = 6;           // of a half of a sphere
constexpr double kThinnest = 1e-4;  // m, of a block's height
// m: the footprint of a lower band says nothing, because its height is an error of less.
constexpr double kLowBand = 0.01;
constexpr double kNearlyLevel = 5e-3;     // m, of heights that count as those of a band's bottom or top
constexpr double kStraight = 5e-4;        // m: corners nearer to the line between their neighbours are left out
constexpr double kSheetThickness = 0.01;  // m, of a wall without one

struct Detail {
  double error = 0.0;  // m, with which no band is halved any more
  std::size_t bands = 0;
};

Detail DetailOf(SolidUse use) {
  return use == SolidUse::kStatic ? Detail{0.01, 16} : Detail{0.02, 6};
}

struct Polyhedron {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// The radius of a regular polygon with the area of a circle.
double PolygonRadius(double radius) {
  const double step = 2.0 * kPi / kRoundSides;
  return radius * std::sqrt(step / SinCos(step).sin);
}

// Rings of points, bottom up, joined by triangles, and closed at both ends.
Polyhedron FromRings(const std::vector<std::vector<Vec3>>& rings) {
  Polyhedron made;
  for (const std::vector<Vec3>& ring : rings) made.points.insert(made.points.end(), ring.begin(), ring.end());
  const auto sides = static_cast<std::uint32_t>(rings.front().size());
  const auto count = static_cast<std::uint32_t>(rings.size());
  for (std::uint32_t r = 0; r + 1 < count; ++r) {
    for (std::uint32_t i = 0; i < sides; ++i) {
      const std::uint32_t a = r * sides + i;
      const std::uint32_t b = r * sides + (i + 1) % sides;
      made.triangles.push_back({a, b, b + sides});
      made.triangles.push_back({a, b + sides, a + sides});
    }
  }
  const std::uint32_t top = (count - 1) * sides;
  for (std::uint32_t i = 2; i < sides; ++i) {
    made.triangles.push_back({0, i, i - 1});
    made.triangles.push_back({top, top + i - 1, top + i});
  }
  return made;
}

std::vector<Vec3> Ring(double radius_x, double radius_y, double z) {
  std::vector<Vec3> ring;
  for (int i = 0; i < kRoundSides; ++i) {
    // Half a step, so that sides and not corners are towards the axes.
    const SinCosResult angle = SinCos(2.0 * kPi * (i + 0.5) / kRoundSides);
    ring.push_back({radius_x * angle.cos, radius_y * angle.sin, z});
  }
  return ring;
}

// An ellipsoid whose halves are `length` apart.
Polyhedron RoundBody(const Vec3& radii, double length) {
  std::vector<std::vector<Vec3>> rings;
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i <= kRings; ++i) {
      const SinCosResult angle = SinCos(0.5 * kPi * (side < 0.0 ? kRings - i : i) / kRings);
      // A tip of a ring that is a point would have no triangles.
      const double width = std::max(angle.cos, 1e-3);
      const double z = side * (0.5 * length + radii.z * angle.sin);
      rings.push_back(Ring(PolygonRadius(radii.x) * width, PolygonRadius(radii.y) * width, z));
    }
  }
  return FromRings(rings);
}

Polyhedron PolyhedronOf(const SolidShape& solid) {
  switch (solid.kind) {
    case SolidShape::Kind::kBox: {
      const Vec3 h = solid.size * 0.5;
      return FromRings({{{-h.x, -h.y, -h.z}, {h.x, -h.y, -h.z}, {h.x, h.y, -h.z}, {-h.x, h.y, -h.z}},
                        {{-h.x, -h.y, h.z}, {h.x, -h.y, h.z}, {h.x, h.y, h.z}, {-h.x, h.y, h.z}}});
    }
    case SolidShape::Kind::kCylinder:
    case SolidShape::Kind::kCone: {
      const double r = PolygonRadius(solid.radius);
      const double tip = solid.kind == SolidShape::Kind::kCone ? 1e-3 * r : r;
      return FromRings({Ring(r, r, -0.5 * solid.length), Ring(tip, tip, 0.5 * solid.length)});
    }
    case SolidShape::Kind::kSphere:
      return RoundBody({solid.radius, solid.radius, solid.radius}, 0.0);
    case SolidShape::Kind::kCapsule:
      return RoundBody({solid.radius, solid.radius, solid.radius}, solid.length);
    case SolidShape::Kind::kEllipsoid:
      return RoundBody(solid.size, 0.0);
    case SolidShape::Kind::kPrism: {
      std::vector<Vec3> bottom;
      std::vector<Vec3> top;
      for (const Vec2& corner : solid.outline) {
        bottom.push_back({corner.x(), corner.y(), 0.0});
        top.push_back({corner.x(), corner.y(), solid.length});
      }
      return FromRings({bottom, top});
    }
    case SolidShape::Kind::kMesh:
      break;
  }
  return {};
}

// Counter-clockwise, without corners that are nearly straight (Andrew's monotone chain).
Polygon HullOf(Polygon points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  Polygon hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Vec2& p : points) {
      while (hull.size() >= first + 2 && !(Cross(hull.back() - hull[hull.size() - 2], p - hull.back()) > 0.0)) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

// m, from a point to a convex polygon, a segment or a point; 0 inside.
double DistanceTo(const Polygon& polygon, const Vec2& p) {
  if (polygon.empty()) return 0.0;
  bool is_inside = polygon.size() >= 3;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& a = polygon[i];
    is_inside = is_inside && Cross(polygon[(i + 1) % polygon.size()] - a, p - a) >= 0.0;
  }
  return is_inside ? 0.0 : DistanceToEdges(polygon, p);
}

Polygon WithoutStraightCorners(Polygon hull) {
  for (std::size_t i = 0; i < hull.size() && hull.size() > 3;) {
    const Vec2& before = hull[(i + hull.size() - 1) % hull.size()];
    const Vec2& after = hull[(i + 1) % hull.size()];
    if (DistanceToSegment(hull[i], before, after) < kStraight) {
      hull.erase(hull.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
  return hull;
}

// A wall of the usual thickness in place of a sheet that has none; a hull with an area as it is.
Polygon Thickened(Polygon hull) {
  if (hull.size() < 2) return {};
  Vec2 a = hull[0];
  Vec2 b = hull[1];
  double longest = 0.0;
  for (const Vec2& p : hull) {
    for (const Vec2& q : hull) {
      const double distance = (q - p).squaredNorm();
      if (distance <= longest) continue;
      longest = distance;
      a = p;
      b = q;
    }
  }
  if (!(longest > kStraight * kStraight)) return {};
  double thickness = 0.0;
  const Vec2 along = (b - a) / std::sqrt(longest);
  for (const Vec2& p : hull) thickness = std::max(thickness, std::fabs(Cross(along, p - a)));
  if (hull.size() >= 3 && thickness > kStraight) return WithoutStraightCorners(std::move(hull));
  const Vec2 aside = Vec2(-along.y(), along.x()) * (0.5 * kSheetThickness);
  return {a - aside, b - aside, b + aside, a + aside};
}

// A band of heights with the hull of the solid in it.
struct Band {
  double low = 0.0;
  double high = 0.0;
  Polygon hull;
  double error = 0.0;
};

class BandMaker {
 public:
  BandMaker(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles)
      : points_(points), triangles_(triangles) {}

  Band Make(double low, double high) const {
    Polygon inside;
    Polygon at_low;
    Polygon at_high;
    for (const auto& t : triangles_) {
      for (std::size_t k = 0; k < 3; ++k) {
        AddEdge(points_[t[k]], points_[t[(k + 1) % 3]], low, high, inside, at_low, at_high);
      }
    }
    Band band{low, high, HullOf(std::move(inside)), 0.0};
    const Polygon bottom = HullOf(std::move(at_low));
    const Polygon top = HullOf(std::move(at_high));
    for (const Vec2& corner : band.hull) {
      if (high - low <= kLowBand) break;
      band.error = std::max({band.error, DistanceTo(bottom, corner), DistanceTo(top, corner)});
    }
    return band;
  }

 private:
  // The part of an edge between two heights, and its parts at the bottom and at the top of the band.
  static void AddEdge(const Vec3& p, const Vec3& q, double low, double high, Polygon& inside, Polygon& at_low,
                      Polygon& at_high) {
    const Vec3& a = p.z <= q.z ? p : q;
    const Vec3& b = p.z <= q.z ? q : p;
    const auto add = [&](double from, double to, Polygon& part) {
      if (a.z > to || b.z < from) return;
      const auto at = [&](double z) {
        if (z <= a.z) return Vec2(a.x, a.y);
        if (z >= b.z) return Vec2(b.x, b.y);
        const double t = (z - a.z) / (b.z - a.z);
        return Vec2(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y));
      };
      part.push_back(at(from));
      part.push_back(at(to));
      if (a.z == b.z) part.emplace_back(b.x, b.y);
    };
    add(low, high, inside);
    // Not at one height only: a face that its author thought level is none after rounding.
    const double nearly = std::min(kNearlyLevel, 0.25 * (high - low));
    add(low, low + nearly, at_low);
    add(high - nearly, high, at_high);
  }

  const std::vector<Vec3>& points_;
  const std::vector<std::array<std::uint32_t, 3>>& triangles_;
};

}  // namespace

SolidBlocks HullsInBands(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                         SolidUse use) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const auto& t : triangles) {
    for (const std::uint32_t corner : t) {
      low = std::min(low, points[corner].z);
      high = std::max(high, points[corner].z);
    }
  }
  SolidBlocks made;
  if (!(high - low > kThinnest)) return made;
  const Detail detail = DetailOf(use);
  const BandMaker maker(points, triangles);
  std::vector<Band> bands = {maker.Make(low, high)};
  while (bands.size() < detail.bands) {
    const auto worst =
        std::max_element(bands.begin(), bands.end(), [](const Band& a, const Band& b) { return a.error < b.error; });
    if (worst->error <= detail.error) break;
    const double middle = 0.5 * (worst->low + worst->high);
    Band upper = maker.Make(middle, worst->high);
    *worst = maker.Make(worst->low, middle);
    bands.insert(worst + 1, std::move(upper));
  }
  for (Band& band : bands) {
    made.error = std::max(made.error, band.error);
    Result<Polygon> outline = Normalized(Thickened(std::move(band.hull)));
    if (outline.ok()) made.blocks.push_back({std::move(outline).value(), {band.low, band.high}});
  }
  return made;
}

double LowestPoint(const SolidShape& solid, const Transform3& T) {
  double lowest = std::numeric_limits<double>::infinity();
  if (solid.kind == SolidShape::Kind::kMesh) {
    for (const auto& t : solid.mesh->triangles) {
      for (const std::uint32_t corner : t) {
        const Vec3& p = solid.mesh->points[corner];
        lowest = std::min(lowest, (T * Vec3{p.x * solid.size.x, p.y * solid.size.y, p.z * solid.size.z}).z);
      }
    }
  } else {
    for (const Vec3& p : PolyhedronOf(solid).points) lowest = std::min(lowest, (T * p).z);
  }
  return lowest;
}

SolidBlocks BlocksOf(const SolidShape& solid, const Transform3& T, SolidUse use) {
  if (solid.kind == SolidShape::Kind::kMesh) {
    TriangleMesh placed = *solid.mesh;
    for (Vec3& p : placed.points) p = T * Vec3{p.x * solid.size.x, p.y * solid.size.y, p.z * solid.size.z};
    if (solid.size.x * solid.size.y * solid.size.z < 0.0) {
      // A mirror turns triangles inside out.
      for (auto& t : placed.triangles) std::swap(t[1], t[2]);
    }
    return MeshBlocks(placed, use);
  }
  const bool is_upright_prism = solid.kind == SolidShape::Kind::kPrism && IsVertical(T.z_axis());
  if (is_upright_prism) {
    const bool is_up = T.z_axis().z > 0.0;
    Polygon outline;
    for (const Vec2& corner : solid.outline) {
      const Vec3 p = T * Vec3{corner.x(), corner.y(), 0.0};
      outline.emplace_back(p.x, p.y);
    }
    Result<Polygon> normalized = Normalized(outline);
    if (!normalized.ok()) normalized = Normalized(HullOf(outline));
    SolidBlocks made;
    const double z = T.translation().z;
    if (normalized.ok() && solid.length > kThinnest) {
      made.blocks.push_back(
          {std::move(normalized).value(), is_up ? ZRange{z, z + solid.length} : ZRange{z - solid.length, z}});
    }
    return made;
  }
  Polyhedron body = PolyhedronOf(solid);
  for (Vec3& p : body.points) p = T * p;
  return HullsInBands(body.points, body.triangles, use);
}

}  // namespace troupe
