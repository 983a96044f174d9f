#include "troupe/result.h"

#include <gtest/gtest.h>

namespace troupe {
namespace {

TEST(Result, IsAValueOrAnError) {
  const Result<int> good(7);
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(good.value(), 7);
  const Result<int> bad(Error{.where = {}, .message = "no"});
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().message, "no");
}

TEST(Error, NamesThePlaceAsFarAsItIsKnown) {
  EXPECT_EQ((Error{.where = {"a.world", 3, 14}, .message = "found x"}.ToString()), "a.world:3:14: error: found x");
  EXPECT_EQ((Error{.where = {"a.world", 3, 0}, .message = "found x"}.ToString()), "a.world:3: error: found x");
  EXPECT_EQ((Error{.where = {"a.world", 0, 0}, .message = "found x"}.ToString()), "a.world: error: found x");
  EXPECT_EQ((Error{.where = {}, .message = "found x"}.ToString()), "error: found x");
  EXPECT_EQ((Warning{.where = {"a.world", 1, 1}, .message = "odd"}.ToString()), "a.world:1:1: warning: odd");
}

TEST(CheckDeathTest, NamesTheBrokenContract) {
  const Result<int> bad(Error{.where = {}, .message = "no"});
  EXPECT_DEATH(bad.value(), "check failed: ok()");
}

}  // namespace
}  // namespace troupe
