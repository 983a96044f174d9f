#include "common/base/sin_cos_of.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "common/base/sin_cos_polynomials.h"

namespace troupe {
namespace {

constexpr std::size_t kLanes = 16;  // two vectors of the widest instructions, so that neither waits for itself

using Doubles [[gnu::vector_size(kLanes * sizeof(double))]] = double;
using Bits [[gnu::vector_size(kLanes * sizeof(double))]] = std::int64_t;

// SinCos for each lane of `angles`, all of which are within kMaxDirectAngle, without a jump.
[[gnu::always_inline]] inline void SinCosOfLanes(const double* angles, double* sines, double* cosines) {
  constexpr double kNoFraction = 0x1.8p52;  // a sum with it is rounded to a whole number, whose last bits it has
  constexpr std::int64_t kSign = std::numeric_limits<std::int64_t>::min();
  Doubles x;
  std::memcpy(&x, angles, sizeof x);
  const Doubles shifted = x * (2.0 / kPi) + kNoFraction;
  const Bits turn = Bits(shifted);
  // Of the sign of the angle, as that of std::nearbyint is.
  const Doubles quadrant = Doubles(Bits(shifted - kNoFraction) | (Bits(x) & kSign));
  Doubles sin;
  Doubles cos;
  SinCosInQuadrant(x, quadrant, sin, cos);
  const Bits s = Bits(sin);
  const Bits c = Bits(cos);
  const Bits swaps = -(turn & 1);
  const Bits sine = (s & ~swaps) | (c & swaps);
  const Bits cosine = (c & ~swaps) | (s & swaps);
  const Doubles out_sine = Doubles(sine ^ ((turn & 2) << 62));
  const Doubles out_cosine = Doubles(cosine ^ (((turn + 1) & 2) << 62));
  std::memcpy(sines, &out_sine, sizeof out_sine);
  std::memcpy(cosines, &out_cosine, sizeof out_cosine);
}

void ComputeAnywhere(const double* angles, double* sines, double* cosines) {
  SinCosOfLanes(angles, sines, cosines);
}
#ifdef TROUPE_HAS_AVX512
[[gnu::target("avx2")]] void ComputeByAvx2(const double* angles, double* sines, double* cosines) {
  SinCosOfLanes(angles, sines, cosines);
}
[[gnu::target("avx512f")]] void ComputeByAvx512(const double* angles, double* sines, double* cosines) {
  SinCosOfLanes(angles, sines, cosines);
}
#endif

constexpr auto kVariants = std::to_array<Variant<SinCosOfSixteen>>({
    {Instructions::kAny, &ComputeAnywhere},
#ifdef TROUPE_HAS_AVX512
    {Instructions::kAvx2, &ComputeByAvx2},
    {Instructions::kAvx512, &ComputeByAvx512},
#endif
});

SinCosOfSixteen* const kQuickestSinCos = RunnableOf(kVariants).back().run;

}  // namespace

std::span<const Variant<SinCosOfSixteen>> SinCosVariants() {
  return RunnableOf(kVariants);
}

void SinCosOf(std::span<const double> radians, std::span<SinCosResult> results) {
  std::array<double, kLanes> angles{};
  std::array<double, kLanes> sines;
  std::array<double, kLanes> cosines;
  for (std::size_t first = 0; first < radians.size(); first += kLanes) {
    const std::size_t count = std::min(kLanes, radians.size() - first);
    bool are_small = true;
    for (std::size_t i = 0; i < count; ++i) {
      angles[i] = radians[first + i];
      are_small &= std::abs(angles[i]) <= kMaxDirectAngle;
    }
    if (!are_small) {
      for (std::size_t i = first; i < first + count; ++i) results[i] = SinCos(radians[i]);
      continue;
    }
    kQuickestSinCos(angles.data(), sines.data(), cosines.data());
    for (std::size_t i = 0; i < count; ++i) results[first + i] = {sines[i], cosines[i]};
  }
}

}  // namespace troupe
