#include "worldfile/sites/site_projection.h"

#include <charconv>
#include <cmath>

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

// WGS 84.
constexpr double kRadius = 6378137.0;  // m, at the equator
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kE2 = kFlattening * (2.0 - kFlattening);  // square of the eccentricity

// The length of the meridian from the equator, m.
double MeridianArc(double latitude) {
  constexpr double e4 = kE2 * kE2;
  constexpr double e6 = e4 * kE2;
  return kRadius * ((1.0 - kE2 / 4.0 - 3.0 * e4 / 64.0 - 5.0 * e6 / 256.0) * latitude -
                    (3.0 * kE2 / 8.0 + 3.0 * e4 / 32.0 + 45.0 * e6 / 1024.0) * SinCos(2.0 * latitude).sin +
                    (15.0 * e4 / 256.0 + 45.0 * e6 / 1024.0) * SinCos(4.0 * latitude).sin -
                    (35.0 * e6 / 3072.0) * SinCos(6.0 * latitude).sin);
}

// By its series, for the maps' |x| of at most pi: libraries choose the last bits of their functions.
double Sinh(double x) {
  double term = x;
  double sum = x;
  for (int k = 1; k <= 16; ++k) {
    term *= x * x / (2.0 * k * (2.0 * k + 1.0));
    sum += term;
  }
  return sum;
}

}  // namespace

// Snyder, "Map projections: a working manual", equations 8-9 to 8-15.
Vec2 TransverseMercator::Project(double longitude_degrees, double latitude_degrees) const {
  const double phi = DegreesToRadians(latitude_degrees);
  const SinCosResult at = SinCos(phi);
  const double n = kRadius / std::sqrt(1.0 - kE2 * at.sin * at.sin);
  const double t = (at.sin / at.cos) * (at.sin / at.cos);
  constexpr double ep2 = kE2 / (1.0 - kE2);
  const double c = ep2 * at.cos * at.cos;
  // Wrapped: across the date line the difference is small, not almost a turn.
  const double a = WrapAngle(DegreesToRadians(longitude_degrees) - longitude) * at.cos;
  const double a2 = a * a;
  const double east =
      n * a * (1.0 + a2 / 6.0 * ((1.0 - t + c) + a2 / 20.0 * (5.0 - 18.0 * t + t * t + 72.0 * c - 58.0 * ep2)));
  const double north = MeridianArc(phi) - MeridianArc(latitude) +
                       n * (at.sin / at.cos) * a2 / 2.0 *
                           (1.0 + a2 / 12.0 *
                                      ((5.0 - t + 9.0 * c + 4.0 * c * c) +
                                       a2 / 30.0 * (61.0 - 58.0 * t + t * t + 600.0 * c - 330.0 * ep2)));
  return {false_easting + scale * east, false_northing + scale * north};
}

std::optional<TransverseMercator> ProjectionOf(const std::string& crs) {
  constexpr std::string_view kPrefix = "EPSG:";
  const std::string_view text = crs;
  if (!text.starts_with(kPrefix)) return std::nullopt;
  int code = 0;
  const auto [end, error] = std::from_chars(text.data() + kPrefix.size(), text.data() + text.size(), code);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (code == 3414) {
    return TransverseMercator{DegreesToRadians(1.0 + 22.0 / 60.0), DegreesToRadians(103.0 + 50.0 / 60.0), 1.0,
                              28001.642, 38744.572};
  }
  const bool is_north = code >= 32601 && code <= 32660;
  const bool is_south = code >= 32701 && code <= 32760;
  if (!is_north && !is_south) return std::nullopt;
  const int zone = code - (is_north ? 32600 : 32700);
  return TransverseMercator{0.0, DegreesToRadians(6.0 * zone - 183.0), 0.9996, 500'000.0,
                            is_north ? 0.0 : 10'000'000.0};
}

Vec2 FromWebMercator(const Vec2& pixel) {
  // Files have y with either sign.
  const double north = kPi * (128.0 - std::fabs(pixel.y())) / 128.0;
  return {180.0 * (pixel.x() - 128.0) / 128.0, RadiansToDegrees(Atan2(Sinh(north), 1.0))};
}

}  // namespace troupe
