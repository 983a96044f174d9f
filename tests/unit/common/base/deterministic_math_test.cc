#include "troupe/deterministic_math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <span>
#include <vector>

#include "common/base/hash.h"
#include "common/base/sin_cos_of.h"
#include "troupe/random.h"

namespace troupe {
namespace {

// Distance of `value` from the exact result, in units of the last place of a double of that size.
double ErrorInUlps(double value, long double exact) {
  const double rounded = static_cast<double>(exact);
  const double ulp =
      std::max(std::nextafter(std::abs(rounded), std::numeric_limits<double>::infinity()) - std::abs(rounded),
               std::numeric_limits<double>::denorm_min());
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / ulp);
}

double Draw(std::uint64_t stream, std::uint64_t i, double low, double high) {
  return low + (high - low) * RandomUniform({stream, i});
}

TEST(SinCos, IsWithinTwoUlps) {
  double worst = 0.0;
  for (double range : {1e-6, 1.0, 4.0, 100.0, 1e4, 1e5}) {
    for (std::uint64_t i = 0; i < 50'000; ++i) {
      const double x = Draw(1, i, -range, range);
      const SinCosResult result = SinCos(x);
      const long double s = std::sin(static_cast<long double>(x));
      const long double c = std::cos(static_cast<long double>(x));
      worst = std::max({worst, ErrorInUlps(result.sin, s), ErrorInUlps(result.cos, c)});
    }
  }
  EXPECT_LE(worst, 2.0);
}

TEST(SinCos, IsExactWhereItMatters) {
  EXPECT_EQ(SinCos(0.0).sin, 0.0);
  EXPECT_EQ(SinCos(0.0).cos, 1.0);
  EXPECT_NEAR(SinCos(kPi / 2.0).cos, 0.0, 1e-16);
  EXPECT_EQ(SinCos(kPi / 2.0).sin, 1.0);
  EXPECT_EQ(SinCos(kPi).cos, -1.0);
  EXPECT_NEAR(SinCos(kPi).sin, 0.0, 2e-16);
  EXPECT_EQ(SinCos(-kPi / 2.0).sin, -1.0);
}

std::uint64_t BitsOf(const SinCosResult& result) {
  Hasher hasher;
  hasher.Add(std::bit_cast<std::uint64_t>(result.sin));
  hasher.Add(std::bit_cast<std::uint64_t>(result.cos));
  return hasher.value();
}

// Of all quadrants and sizes, next to the limits of quadrants, and both zeros.
std::vector<double> AnglesOfAllKinds() {
  std::vector<double> angles = {0.0, -0.0};
  for (int quadrant = -40; quadrant <= 40; ++quadrant) {
    const double limit = quadrant * kPi / 4.0;
    angles.insert(angles.end(), {limit, std::nextafter(limit, -10.0), std::nextafter(limit, 10.0)});
  }
  for (double range : {1e-300, 1e-6, 1.0, 4.0, 100.0, 1e5}) {
    for (std::uint64_t i = 0; i < 20'000; ++i) angles.push_back(Draw(2, i, -range, range));
  }
  while (angles.size() % 16 != 0) angles.push_back(1.0);
  return angles;
}

TEST(SinCos, HasTheSameBitsByAllInstructions) {
  const std::vector<double> angles = AnglesOfAllKinds();
  ASSERT_FALSE(SinCosVariants().empty());
  for (const auto& [needs, compute] : SinCosVariants()) {
    for (std::size_t first = 0; first < angles.size(); first += 16) {
      double sines[16];
      double cosines[16];
      compute(&angles[first], sines, cosines);
      for (std::size_t i = 0; i < 16; ++i) {
        ASSERT_EQ(BitsOf({sines[i], cosines[i]}), BitsOf(SinCos(angles[first + i]))) << angles[first + i];
      }
    }
  }
}

TEST(SinCos, OfAnyNumberOfAnyAnglesHasTheBitsOfOne) {
  std::vector<double> angles = AnglesOfAllKinds();
  angles.resize(100);
  for (double large : {1e6, -1e100, std::numeric_limits<double>::infinity()}) angles.push_back(large);
  angles.insert(angles.end(), 30, 2.5);
  for (std::size_t count = 0; count <= angles.size(); ++count) {
    std::vector<SinCosResult> results(count);
    SinCosOf(std::span(angles).first(count), results);
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(BitsOf(results[i]), BitsOf(SinCos(angles[i]))) << angles[i];
  }
}

TEST(SinCos, CopesWithAnyNumber) {
  for (double x : {1e6, 1e15, -1e100, std::numeric_limits<double>::max()}) {
    const SinCosResult result = SinCos(x);
    EXPECT_NEAR(result.sin * result.sin + result.cos * result.cos, 1.0, 1e-15);
  }
  for (double x : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(std::isnan(SinCos(x).sin));
    EXPECT_TRUE(std::isnan(SinCos(x).cos));
  }
}

TEST(Atan2, IsWithinTwoUlps) {
  double worst = 0.0;
  for (double range : {1e-3, 1.0, 1e3, 1e6}) {
    for (std::uint64_t i = 0; i < 50'000; ++i) {
      const double y = Draw(2, i, -range, range);
      const double x = Draw(3, i, -1.0, 1.0);
      worst = std::max(worst,
                       ErrorInUlps(Atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x))));
    }
  }
  EXPECT_LE(worst, 2.0);
}

TEST(Atan2, IsExactOnTheAxes) {
  EXPECT_EQ(Atan2(0.0, 0.0), 0.0);
  EXPECT_EQ(Atan2(0.0, 1.0), 0.0);
  EXPECT_EQ(Atan2(0.0, -1.0), kPi);
  EXPECT_EQ(Atan2(-0.0, -1.0), kPi) << "the result is in (-pi, pi]";
  EXPECT_EQ(Atan2(1.0, 0.0), kPi / 2.0);
  EXPECT_EQ(Atan2(-1.0, 0.0), -kPi / 2.0);
  EXPECT_EQ(Atan2(1.0, 1.0), kPi / 4.0);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Atan2(infinity, 1.0), kPi / 2.0);
  EXPECT_EQ(Atan2(1.0, infinity), 0.0);
  EXPECT_EQ(Atan2(infinity, -infinity), 3.0 * kPi / 4.0);
  EXPECT_TRUE(std::isnan(Atan2(std::nan(""), 1.0)));
}

TEST(Log, IsWithinTwoUlps) {
  double worst = 0.0;
  for (std::uint64_t i = 0; i < 100'000; ++i) {
    const double mantissa = Draw(4, i, 0.5, 2.0);
    const int exponent = static_cast<int>(RandomBits({5, i}) % 2000) - 1000;
    for (double x : {mantissa, std::ldexp(mantissa, exponent)}) {
      worst = std::max(worst, ErrorInUlps(Log(x), std::log(static_cast<long double>(x))));
    }
  }
  EXPECT_LE(worst, 2.0);
  EXPECT_EQ(Log(1.0), 0.0);
}

TEST(WrapAngle, StaysInRangeAndKeepsTheDirection) {
  EXPECT_EQ(WrapAngle(kPi), kPi);
  EXPECT_EQ(WrapAngle(-kPi), kPi);
  EXPECT_EQ(WrapAngle(0.5), 0.5);
  EXPECT_NEAR(WrapAngle(3.0 * kPi), kPi, 1e-15);
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    const double x = Draw(6, i, -100.0, 100.0);
    const double wrapped = WrapAngle(x);
    ASSERT_GT(wrapped, -kPi);
    ASSERT_LE(wrapped, kPi);
    ASSERT_NEAR(SinCos(wrapped).sin, SinCos(x).sin, 1e-13);
    ASSERT_NEAR(SinCos(wrapped).cos, SinCos(x).cos, 1e-13);
    ASSERT_EQ(WrapAngle(wrapped), wrapped) << "wrapping twice changes nothing";
  }
}

TEST(DeterministicMath, GivesTheSameBitsEverywhere) {
  Hasher hasher;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    const double x = Draw(7, i, -50.0, 50.0);
    const double y = Draw(8, i, -5.0, 5.0);
    const SinCosResult trig = SinCos(x);
    hasher.Add(trig.sin);
    hasher.Add(trig.cos);
    hasher.Add(Atan2(y, x));
    hasher.Add(Log(std::abs(x) + 1e-3));
    hasher.Add(WrapAngle(x));
  }
  EXPECT_EQ(hasher.value(), 0xb4b8eafc0eb46ea1u);
}

TEST(Random, IsAFunctionOfTheKey) {
  EXPECT_EQ(RandomBits({1, 2, 3}), RandomBits({1, 2, 3}));
  EXPECT_NE(RandomBits({1, 2, 3}), RandomBits({3, 2, 1}));
  EXPECT_NE(RandomBits({1, 2, 3}), RandomBits({1, 2, 4}));
  EXPECT_NE(RandomBits({1, 2}), RandomBits({1, 2, 0}));
}

TEST(Random, IsTheSameOnEveryMachine) {
  EXPECT_EQ(RandomBits({42, 7}), 0x625998c9794ec1e9u);
  EXPECT_EQ(RandomUniform({42, 7}), 0x1.89666325e53bp-2);
  EXPECT_EQ(RandomNormal({42, 7}), 0x1.4451306fcca02p-1);
}

TEST(Random, UniformFillsTheUnitIntervalEvenly) {
  constexpr int kDraws = 200'000;
  constexpr int kBins = 20;
  std::vector<int> bins(kBins, 0);
  double sum = 0.0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double u = RandomUniform({5, i});
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++bins[static_cast<std::size_t>(u * kBins)];
    sum += u;
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 0.003);
  for (int count : bins) EXPECT_NEAR(count, kDraws / kBins, 500);
}

TEST(Random, NormalHasMeanZeroAndVarianceOne) {
  constexpr int kDraws = 200'000;
  double sum = 0.0;
  double squares = 0.0;
  double fourth = 0.0;
  double neighbours = 0.0;
  double before = 0.0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double x = RandomNormal({6, i});
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    neighbours += x * before;
    before = x;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.02);
  EXPECT_NEAR(fourth / kDraws, 3.0, 0.12) << "kurtosis";
  EXPECT_NEAR(neighbours / kDraws, 0.0, 0.01) << "neighbouring draws are independent";
}

template <typename... Values>
std::uint64_t HashOf(const Values&... values) {
  Hasher hasher;
  (hasher.Add(values), ...);
  return hasher.value();
}

TEST(Hasher, IsTheSameOnEveryMachine) {
  EXPECT_EQ(HashOf(std::uint64_t{0}), 0x860373475de17cc5u);
  EXPECT_EQ(HashOf(1.5, std::string_view("robot")), 0xe2b48a82f3cac027u);
}

TEST(Hasher, DistinguishesOrderAndGrouping) {
  EXPECT_NE(HashOf(1.0, 2.0), HashOf(2.0, 1.0));
  EXPECT_NE(HashOf(std::string_view("ab"), std::string_view("c")),
            HashOf(std::string_view("a"), std::string_view("bc")));
  EXPECT_NE(HashOf(std::string_view("")), HashOf());
  EXPECT_NE(HashOf(std::uint64_t{0}), HashOf(std::uint64_t{0}, std::uint64_t{0}));
}

TEST(Hasher, TreatsOnlyTheTwoZerosAlike) {
  EXPECT_EQ(HashOf(0.0), HashOf(-0.0));
  EXPECT_NE(HashOf(1.0), HashOf(std::nextafter(1.0, 2.0)));
  EXPECT_NE(HashOf(1.0), HashOf(-1.0));
}

TEST(Hasher, SpreadsNeighbouringWords) {
  std::set<std::uint64_t> seen;
  int ones = 0;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    seen.insert(HashOf(i));
    ones += std::popcount(HashOf(i) ^ HashOf(i + 1));
  }
  EXPECT_EQ(seen.size(), 10'000u);
  EXPECT_NEAR(ones / 10'000.0, 32.0, 0.5) << "bits that differ between neighbours";
}

}  // namespace
}  // namespace troupe
