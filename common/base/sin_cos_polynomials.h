// The arithmetic of SinCos, for one number or a vector of numbers. Private to this folder.
#pragma once

namespace troupe {

constexpr double kMaxDirectAngle = 1e5;  // rad; SinCos first reduces larger ones

// pi/2 in three parts. The first two have 33 significant bits, so that their product with an integer below 2^20 is
// exact (Cody and Waite 1980, chapter 8).
constexpr double kHalfPiHigh = 0x1.921fb544p+0;
constexpr double kHalfPiMiddle = 0x1.0b4611a6p-34;
constexpr double kHalfPiLow = 0x1.3198a2e037073p-69;

// All functions are inlined, so that no call depends on how a processor passes vectors.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

// Taylor polynomials: on [-pi/4, pi/4] their first left-out term is below 2^-58.
template <typename Number>
[[gnu::always_inline]] inline Number SinPolynomial(const Number& x) {
  const Number z = x * x;
  Number sum = 1.0 / 355687428096000.0 * z - 1.0 / 1307674368000.0;  // 1/15!
  sum = sum * z + 1.0 / 6227020800.0;                                // 1/13!
  sum = sum * z - 1.0 / 39916800.0;                                  // 1/11!
  sum = sum * z + 1.0 / 362880.0;                                    // 1/9!
  sum = sum * z - 1.0 / 5040.0;                                      // 1/7!
  sum = sum * z + 1.0 / 120.0;                                       // 1/5!
  sum = sum * z - 1.0 / 6.0;                                         // 1/3!
  return x + x * z * sum;
}

template <typename Number>
[[gnu::always_inline]] inline Number CosPolynomial(const Number& x) {
  const Number z = x * x;
  Number sum = 1.0 / 20922789888000.0 * z - 1.0 / 87178291200.0;  // 1/14!
  sum = sum * z + 1.0 / 479001600.0;                              // 1/12!
  sum = sum * z - 1.0 / 3628800.0;                                // 1/10!
  sum = sum * z + 1.0 / 40320.0;                                  // 1/8!
  sum = sum * z - 1.0 / 720.0;                                    // 1/6!
  sum = sum * z + 1.0 / 24.0;                                     // 1/4!
  return 1.0 - (0.5 * z - z * z * sum);
}

// Sine and cosine of `radians` less `quadrant` quarter turns. REQUIRES: `quadrant` is the nearest whole number of them
template <typename Number>
[[gnu::always_inline]] inline void SinCosInQuadrant(const Number& radians, const Number& quadrant, Number& sine,
                                                    Number& cosine) {
  // The reduced angle as a sum: `rest` is the part that rounding cut off `reduced`; it changes the last bit or two.
  const Number high = radians - quadrant * kHalfPiHigh;
  const Number middle = quadrant * kHalfPiMiddle;
  const Number reduced = high - middle;
  const Number rest = ((high - reduced) - middle) - quadrant * kHalfPiLow;
  const Number sin = SinPolynomial(reduced);
  const Number cos = CosPolynomial(reduced);
  sine = sin + rest * cos;
  cosine = cos - rest * sin;
}

#pragma GCC diagnostic pop

}  // namespace troupe
