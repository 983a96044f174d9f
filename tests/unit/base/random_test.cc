#include "troupe/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace troupe {
namespace {

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

}  // namespace
}  // namespace troupe
