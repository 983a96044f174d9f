#include "launcher/shell_words.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "launcher/far_messages.h"

namespace troupe {
namespace {

TEST(ShellWords, AreQuotedWhereAShellWouldReadThemOtherwise) {
  EXPECT_EQ(Quoted(std::vector<std::string>{"a/b", "c d", "it's", ""}), "a/b 'c d' 'it'\\''s' ''");
}

TEST(ShellWords, FillInWhatIsKnownAndLeaveOtherBraces) {
  EXPECT_EQ(FillIn("ssh {host} ${HOME} {x {host}", {{"host", "h1"}}), "ssh h1 ${HOME} {x h1");
}

TEST(FarMessages, CarryAnyBytes) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  EXPECT_EQ(FromHexadecimal(ToHexadecimal(bytes.data(), bytes.size())), bytes);
}

TEST(FarMessages, AreNoObjectsWhenTheyAreSomethingElse) {
  EXPECT_FALSE(ParseFarMessage("Welcome to Debian").is_object());
  EXPECT_FALSE(ParseFarMessage("17").is_object());
  EXPECT_TRUE(ParseFarMessage(R"({"output":"x"})").is_object());
}

}  // namespace
}  // namespace troupe
