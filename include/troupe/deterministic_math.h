// Elementary functions that give the same bits on every processor with IEEE 754 arithmetic, by every compiler. The
// functions of the C libraries do not: they differ between libraries, and glibc picks another implementation where the
// processor has fused multiply-add. Built from IEEE + - * / and sqrt only, without contraction (-ffp-contract=off).
// Errors stay below 2 units in the last place in the ranges named.
#pragma once

namespace troupe {

inline constexpr double kPi = 3.14159265358979323846;

struct SinCosResult {
  double sin;
  double cos;
};

// Angle in radians, |angle| <= 1e5 (beyond: reduced to that range by fmod first, with less accuracy).
SinCosResult SinCos(double radians);

// In (-pi, pi]; Atan2(0, 0) is 0.
double Atan2(double y, double x);

// Natural logarithm. REQUIRES: x > 0 and finite.
double Log(double x);

double DegreesToRadians(double degrees);
double RadiansToDegrees(double radians);

// The same angle in (-pi, pi].
double WrapAngle(double radians);

}  // namespace troupe
