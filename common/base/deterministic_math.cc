// Functions of numbers with the same bits on every machine: C libraries round the last bit of sine, cosine, arctangent
// and logarithm differently, and a difference in one bit soon is another collision. Only operations that IEEE 754
// rounds correctly are used (+ - * / sqrt, and exact ones such as remainder, fmod and nearbyint), in a fixed order; the
// build forbids contraction to fused operations (-ffp-contract=off).
#include "troupe/deterministic_math.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/base/hash.h"
#include "common/base/sin_cos_polynomials.h"
#include "troupe/random.h"

namespace troupe {
namespace {

// 1/29, -1/27 ... -1/3.
constexpr std::array<double, 14> kAtanCoefficients = [] {
  std::array<double, 14> coefficients{};
  for (int i = 0; i < 14; ++i) coefficients[static_cast<std::size_t>(i)] = (i % 2 == 0 ? 1.0 : -1.0) / (29 - 2 * i);
  return coefficients;
}();

// arctan of |x| <= tan(pi/16), by its power series: 15 terms leave an error below 2^-60.
double AtanSeries(double x) {
  const double z = x * x;
  double sum = 0.0;
  for (const double coefficient : kAtanCoefficients) sum = coefficient + sum * z;
  return x + x * z * sum;
}

// arctan of x >= 0.
double AtanPositive(double x) {
  // arctan(x) = arctan(c) + arctan((x - c) / (1 + x c)); the sectors are pi/8 wide, centred on multiples of pi/8.
  constexpr double kTan1 = 0.19891236737965800;  // tan(pi/16)
  constexpr double kTan2 = 0.41421356237309505;  // tan(pi/8)
  constexpr double kTan3 = 0.66817863791929891;  // tan(3 pi/16)
  constexpr double kTan5 = 1.49660576266548901;  // tan(5 pi/16)
  constexpr double kTan6 = 2.41421356237309505;  // tan(3 pi/8)
  constexpr double kTan7 = 5.02733949212584810;  // tan(7 pi/16)
  if (x <= kTan1) return AtanSeries(x);
  if (x <= kTan3) return kPi / 8.0 + AtanSeries((x - kTan2) / (1.0 + x * kTan2));
  if (x <= kTan5) return kPi / 4.0 + AtanSeries((x - 1.0) / (1.0 + x));
  if (x <= kTan7) return 3.0 * kPi / 8.0 + AtanSeries((x - kTan6) / (1.0 + x * kTan6));
  return kPi / 2.0 - AtanSeries(1.0 / x);
}

double ToUniform(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

}  // namespace

SinCosResult SinCos(double radians) {
  if (!std::isfinite(radians)) return {std::nan(""), std::nan("")};
  if (std::abs(radians) > kMaxDirectAngle) radians = std::fmod(radians, 2.0 * kPi);
  const double quadrant = std::nearbyint(radians * (2.0 / kPi));
  double s;
  double c;
  SinCosInQuadrant(radians, quadrant, s, c);
  switch (static_cast<std::int64_t>(quadrant) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double Atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return std::nan("");
  const double ax = std::abs(x);
  const double ay = std::abs(y);
  if (ax == 0.0 && ay == 0.0) return 0.0;
  double angle;
  if (std::isinf(ax) && std::isinf(ay)) {
    angle = kPi / 4.0;
  } else if (ay <= ax) {
    angle = AtanPositive(ay / ax);
  } else {
    angle = kPi / 2.0 - AtanPositive(ax / ay);
  }
  if (x < 0.0) angle = kPi - angle;
  return y < 0.0 ? -angle : angle;
}

double Log(double x) {
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)); log m = 2 artanh((m - 1) / (m + 1)).
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678118654752) {
    m *= 2.0;
    --exponent;
  }
  const double s = (m - 1.0) / (m + 1.0);
  const double z = s * s;
  double sum = 0.0;
  for (int k = 23; k >= 3; k -= 2) sum = 1.0 / k + sum * z;
  constexpr double kLn2High = 0x1.62e42feep-1;
  constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
  return exponent * kLn2High + (2.0 * s + (2.0 * s * z * sum + exponent * kLn2Low));
}

double DegreesToRadians(double degrees) {
  return degrees * (kPi / 180.0);
}

double RadiansToDegrees(double radians) {
  return radians * (180.0 / kPi);
}

double WrapAngle(double radians) {
  if (radians > -kPi && radians <= kPi) return radians;
  // Of angles from half a turn to twice as many, which sums of two angles are, a turn is subtracted without rounding
  // (Sterbenz 1974), and without the call.
  if (std::abs(radians) < 9.0 && std::abs(radians) != 2.0 * kPi) return radians + (radians > 0.0 ? -2.0 : 2.0) * kPi;
  double wrapped = std::remainder(radians, 2.0 * kPi);  // exact, in [-pi, pi]
  if (wrapped <= -kPi) wrapped += 2.0 * kPi;
  return wrapped;
}

std::uint64_t RandomBits(std::initializer_list<std::uint64_t> key) {
  Hasher hasher;
  for (std::uint64_t word : key) hasher.Add(word);
  return hasher.value();
}

double RandomUniform(std::initializer_list<std::uint64_t> key) {
  return ToUniform(RandomBits(key));
}

double RandomNormal(std::initializer_list<std::uint64_t> key) {
  Hasher hasher;
  for (std::uint64_t word : key) hasher.Add(word);
  // The method of Box and Muller (1958), with one of its two numbers.
  const double u = 1.0 - ToUniform(hasher.value());  // (0, 1], so that the logarithm exists
  hasher.Add(std::uint64_t{1});
  const double angle = 2.0 * kPi * ToUniform(hasher.value());
  return std::sqrt(-2.0 * Log(u)) * SinCos(angle).cos;
}

}  // namespace troupe
