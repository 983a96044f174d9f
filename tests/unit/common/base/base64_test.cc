#include "common/base/base64.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace troupe {
namespace {

TEST(Base64, IsReadAsItWasWritten) {
  // Section 10 of RFC 4648.
  for (const auto& [bytes, text] : {std::pair{"", ""}, std::pair{"f", "Zg=="}, std::pair{"fo", "Zm8="},
                                    std::pair{"foo", "Zm9v"}, std::pair{"foobar", "Zm9vYmFy"}}) {
    EXPECT_EQ(Base64(bytes), text);
    EXPECT_EQ(FromBase64(text), bytes);
  }
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  EXPECT_EQ(FromBase64(Base64(all)), all);
}

TEST(Base64, RefusesOtherTexts) {
  for (const char* const text : {"Z", "Zg=", "Zg", "====", "Zm9v\n", "Zm9-", "=m9v"}) {
    EXPECT_EQ(FromBase64(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace troupe
