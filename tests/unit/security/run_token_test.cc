#include "transport/security/run_token.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/files.h"

namespace troupe {
namespace {

using testing::HasSubstr;

constexpr const char* kParticipant = "0110a1b2c3d4e5f601020304";

class RunTokenTest : public testing::Test {
 protected:
  const test::TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(RunTokenTest, AProofIsOfOneParticipantAndOneToken) {
  const RunToken token = RunToken::Make().value();
  const std::string proof = token.Proof(kParticipant);
  EXPECT_EQ(proof.size(), 64u);
  EXPECT_TRUE(token.Accepts(kParticipant, proof));
  EXPECT_FALSE(token.Accepts("0110a1b2c3d4e5f601020305", proof));
  EXPECT_FALSE(token.Accepts(kParticipant, proof.substr(0, 63)));
  EXPECT_FALSE(token.Accepts(kParticipant, ""));
  EXPECT_FALSE(RunToken::Make().value().Accepts(kParticipant, proof));
}

TEST_F(RunTokenTest, ReturnsFromItsFile) {
  EXPECT_FALSE(RunToken::IsIn(folder_));
  const RunToken token = RunToken::Make().value();
  ASSERT_TRUE(token.WriteTo(folder_).ok());
  EXPECT_TRUE(RunToken::IsIn(folder_));
  EXPECT_EQ(RunToken::ReadFrom(folder_).value(), token);
  const std::filesystem::path file = std::filesystem::path(folder_) / kTokenFolder / kTokenFile;
  EXPECT_EQ(std::filesystem::status(file).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST_F(RunTokenTest, AnotherTextIsAnErrorWithItsFile) {
  ASSERT_TRUE(RunToken::Make().value().WriteTo(folder_).ok());
  for (const char* text : {"", "abc", "zz345678901234567890123456789012345678901234567890123456789012"}) {
    std::ofstream(folder_ + "/token/token.hex") << text;
    const Result<RunToken> token = RunToken::ReadFrom(folder_);
    ASSERT_FALSE(token.ok()) << text;
    EXPECT_THAT(token.error().ToString(), HasSubstr("token.hex: error: found another text"));
  }
}

// The HMAC itself is OpenSSL's.
TEST_F(RunTokenTest, TheProofIsHmacSha256) {
  std::filesystem::create_directory(folder_ + "/token");
  std::ofstream(folder_ + "/token/token.hex") << std::string(64, '0');
  // printf %s 0110a1b2c3d4e5f601020304 | openssl dgst -sha256 -mac HMAC -macopt hexkey:00...00 (32 bytes)
  EXPECT_EQ(RunToken::ReadFrom(folder_).value().Proof(kParticipant),
            "4b7bd05c2348a0968fb17ef41f524d5992d39c378c90a77788858cd6a452ab32");
}

}  // namespace
}  // namespace troupe
