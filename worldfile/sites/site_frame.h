// The coordinates of a building's file, to metres of frame W.
//
// A file is in pixels of drawings, one per level with a scale and an orientation of its own, in metres, or on the
// globe. Pixels go through two steps: y up (SiteFrame), then the level's map (AlignLevel), by which fiducials of equal
// names come together on all levels, in the mean. Coordinates of the globe are projected to a plane and shifted to an
// origin near the building, because metres from the equator would waste the digits of the geometry.
//
// All results are rounded to a micrometre (Rounded) before anything depends on them, so that worlds agree between
// machines.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "troupe/vec2.h"
#include "worldfile/sites/site_projection.h"

namespace troupe {

enum class SiteCoordinates : std::uint8_t {
  kReferenceImage,   // pixels of each level's drawing, y down
  kCartesianMeters,  // y up
  kWebMercator,      // a square of 256 around the globe, y down
  kWgs84,            // longitude and latitude, degrees
};

// A point of a level that other levels have, too.
struct SiteFiducial {
  std::string name;
  Vec2 position{0.0, 0.0};  // in coordinates of the file
};

// The length of a line in the file's units, and in metres.
struct SiteMeasurement {
  double length = 0.0;
  double meters = 0.0;
};

// What the file says of the coordinates of one level.
struct LevelPlan {
  std::vector<SiteFiducial> fiducials;
  std::vector<SiteMeasurement> measurements;
};

// A turn, a stretch and a shift: p_W = scale * R(angle) * p + shift.
struct PlaneMap {
  double scale = 1.0;
  double cos = 1.0;
  double sin = 0.0;
  Vec2 shift{0.0, 0.0};

  Vec2 operator*(const Vec2& p) const {
    return scale * Vec2(cos * p.x() - sin * p.y(), sin * p.x() + cos * p.y()) + shift;
  }
};

// The mean of the measurements' scales; nothing without one.
std::optional<double> ScaleOf(const LevelPlan& level);

// The map of a level's drawing to W, such that its fiducials meet the fiducials of the reference level, whose map is a
// stretch by `scale`. Points have y up. Nothing without two common fiducials at different places.
std::optional<PlaneMap> AlignLevel(const LevelPlan& reference, double scale, const LevelPlan& level);

// From coordinates of a file to W, but for the drawings of levels.
class SiteFrame {
 public:
  SiteFrame(SiteCoordinates coordinates, const TransverseMercator& projection, const Vec2& offset)
      : coordinates_(coordinates), projection_(projection), offset_(offset) {}

  // Of a drawing: its pixel with y up. Else metres, less the offset.
  Vec2 operator*(const Vec2& p) const;

 private:
  SiteCoordinates coordinates_;
  TransverseMercator projection_;
  Vec2 offset_;  // m
};

// To a micrometre: the last bits of the functions above differ between machines.
Vec2 Rounded(const Vec2& p);

}  // namespace troupe
