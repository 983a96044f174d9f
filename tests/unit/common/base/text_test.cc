#include "common/base/text.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>

#include "tests/support/without_memory.h"
#include "troupe/result.h"

namespace troupe {
namespace {

// "a", then characters of two, three and four bytes.
const std::string kText = "a\xc3\xa4\xe2\x82\xac\xf0\x9f\xa4\x96";

TEST(Utf8, CutsBetweenCharacters) {
  const std::size_t ends[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 10};
  for (std::size_t longest = 0; longest < 12; ++longest) {
    EXPECT_EQ(CutUtf8(kText, longest), kText.substr(0, ends[longest])) << longest;
  }
  EXPECT_EQ(CutUtf8(std::string(9, '\x80'), 7).size(), 7u) << "no UTF-8 has so many continuations";
}

TEST(Utf8, FindsTheFirstByteThatIsNone) {
  EXPECT_EQ(FindInvalidUtf8(kText), std::string::npos);
  EXPECT_EQ(FindInvalidUtf8("ab\xff"), 2u);
  EXPECT_EQ(FindInvalidUtf8("a\xe2\x82"), 1u) << "cut off";
  EXPECT_EQ(FindInvalidUtf8("\xc0\xaf"), 0u) << "overlong";
  EXPECT_EQ(FindInvalidUtf8("\xed\xa0\x80"), 0u) << "half of a surrogate pair";
  EXPECT_EQ(FindInvalidUtf8("\xf4\x90\x80\x80"), 0u) << "beyond U+10FFFF";
}

TEST(Utf8, APlainLineHasNoControlCharacters) {
  EXPECT_TRUE(IsPlainLine(kText));
  EXPECT_TRUE(IsPlainLine("\xc2\xa0"));
  for (const char* text : {"a\nb", "\x1b[2J", "\x7f",
                           "\xc2\x9b"
                           "2J",
                           "\xff", "a\xc3"})
    EXPECT_FALSE(IsPlainLine(text)) << text;
  EXPECT_FALSE(IsPlainLine(std::string(1, '\0')));
}

TEST(Utf8, AnyTextBecomesAPlainLine) {
  EXPECT_EQ(PlainLine(kText), kText);
  EXPECT_EQ(PlainLine("a\nb\x1b[2J\xc2\x9b\xff\xc3"), "a b [2J ??");
  EXPECT_EQ(PlainLine(kText, 8), kText.substr(0, 6));
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += {static_cast<char>(i), static_cast<char>(255 - i)};
  EXPECT_TRUE(IsPlainLine(PlainLine(bytes)));
}

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

TEST(FloodLimiter, EndsWithoutMemoryForItsLastLine) {
  std::optional<FloodLimiter> lines(std::in_place, [](const std::string&) {});
  for (int i = 0; i < 100; ++i) lines->Add("a line");
  EXPECT_EQ(test::StatusWithoutMemory([&] { lines.reset(); }), 0);
}

// As in the handler of an exception that a lack of memory has caused.
TEST(FloodLimiter, LeavesALineOutWithoutMemory) {
  FloodLimiter lines([](const std::string&) {});
  EXPECT_EQ(test::StatusWithoutMemory([&] { lines.Add("a line that is too long to be kept within the text"); }), 0);
}

TEST(CheckDeathTest, NamesTheBrokenContract) {
  const Result<int> bad(Error{.where = {}, .message = "no"});
  EXPECT_DEATH(bad.value(), "check failed: ok()");
}

}  // namespace
}  // namespace troupe
