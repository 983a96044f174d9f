// Coordinates of sites on the globe: longitudes and latitudes, or Web Mercator, to metres of a map projection.
//
// Written out here instead of a projection library: one projection and the inverse of another are enough for building
// files, and their results must be the same on all machines (deterministic functions, rounded by the caller). Angles in
// the structure are rad, arguments of functions degrees, as files have them.
#pragma once

#include <optional>
#include <string>

#include "troupe/vec2.h"

namespace troupe {

// A transverse Mercator projection of the WGS 84 ellipsoid, in which east and north are metres.
struct TransverseMercator {
  double latitude = 0.0;   // rad, of the origin
  double longitude = 0.0;  // rad, of the central meridian
  double scale = 1.0;
  double false_easting = 0.0;   // m
  double false_northing = 0.0;  // m

  // To (east, north). Within a millimetre, up to three degrees from the central meridian.
  Vec2 Project(double longitude_degrees, double latitude_degrees) const;
};

// The projection of an EPSG code: 3414 (Singapore), 32601 to 32660 and 32701 to 32760 (UTM). Nothing for another.
std::optional<TransverseMercator> ProjectionOf(const std::string& crs);

// Longitude and latitude, degrees, of a place in Web Mercator's square of 256, whose y points down.
Vec2 FromWebMercator(const Vec2& pixel);

}  // namespace troupe
