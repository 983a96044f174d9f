#include <gtest/gtest.h>

#include <string>

#include "common/base/text.h"

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

}  // namespace
}  // namespace troupe
