#include "common/base/hash.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

namespace troupe {
namespace {

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
