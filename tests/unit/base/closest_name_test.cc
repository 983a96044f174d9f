#include <gtest/gtest.h>

#include "common/base/text.h"

namespace troupe {
namespace {

const std::vector<std::string> kNames = {"speed", "ticks", "seed", "scout", "run"};

TEST(ClosestNameTest, FindsTheNameThatDiffersLeast) {
  EXPECT_EQ(ClosestName("sped", kNames), "speed") << "one deletion, as for seed: the first";
  EXPECT_EQ(ClosestName("tick", kNames), "ticks");
  EXPECT_EQ(ClosestName("tikcs", kNames), "ticks") << "neighbours swapped";
  EXPECT_EQ(ClosestName("scot", kNames), "scout");
  EXPECT_EQ(ClosestName("rn", kNames), "run");
  EXPECT_EQ(ClosestName("scout", kNames), "scout");
}

TEST(ClosestNameTest, FindsNothingForOtherWords) {
  EXPECT_EQ(ClosestName("gravity", kNames), std::nullopt);
  EXPECT_EQ(ClosestName("x", {"y"}), std::nullopt);
  EXPECT_EQ(ClosestName("vz", {"vx", "vy"}), std::nullopt) << "short names are all close to each other";
  EXPECT_EQ(ClosestName("", {""}), "");
  EXPECT_EQ(ClosestName("", kNames), std::nullopt);
  EXPECT_EQ(ClosestName("speed", {}), std::nullopt);
  EXPECT_EQ(ClosestName(std::string(1000000, 'a'), {std::string(1000000, 'a')}), std::nullopt);
}

TEST(ClosestNameTest, IsTheEndOfAMessage) {
  EXPECT_EQ(DidYouMean("scot", kNames), "; did you mean 'scout'?");
  EXPECT_EQ(DidYouMean("gravity", kNames), "");
}

}  // namespace
}  // namespace troupe
