#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "common/base/text.h"
#include "launcher/hosts/host.h"

namespace troupe {
namespace {

TEST(ShellWords, AreQuotedIfAShellWouldInterpretThem) {
  EXPECT_EQ(ShellQuoted(std::vector<std::string>{"a/b", "c d", "it's", ""}), "a/b 'c d' 'it'\\''s' ''");
}

TEST(ShellWords, FillInReplacesKnownNamesAndKeepsOtherBraces) {
  EXPECT_EQ(FillIn("ssh {host} ${HOME} {x {host}", {{"host", "h1"}}), "ssh h1 ${HOME} {x h1");
}

TEST(HostMessages, EncodeAllBytes) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  EXPECT_EQ(FromHexadecimal(ToHexadecimal(std::as_bytes(std::span(bytes)))), bytes);
  for (const char* text : {"a", "0g", "AB", "0 "}) EXPECT_EQ(FromHexadecimal(text), std::nullopt) << text;
}

TEST(HostMessages, AreObjectsOrInvalid) {
  EXPECT_FALSE(ParseHostMessage("Welcome to Debian").is_object());
  EXPECT_FALSE(ParseHostMessage("17").is_object());
  EXPECT_TRUE(ParseHostMessage(R"({"output":"x"})").is_object());
}

}  // namespace
}  // namespace troupe
