#include "common/security/run_token.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include <filesystem>
#include <span>
#include <system_error>

#include "common/security/private_folder.h"

namespace troupe {
namespace {

constexpr char kDigits[] = "0123456789abcdef";

std::string PathIn(const std::string& keys) {
  return keys + "/" + kTokenFolder + "/" + kTokenFile;
}

std::string ToHex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

int DigitOf(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

}  // namespace

Result<RunToken> RunToken::Make() {
  RunToken token;
  if (RAND_bytes(token.secret_.data(), static_cast<int>(token.secret_.size())) == 1) return token;
  return Failure("no random numbers for the token of a run");
}

Result<RunToken> RunToken::ReadFrom(const std::string& keys) {
  const std::string path = PathIn(keys);
  const Result<std::string> text = ReadWholeFile(path);
  if (!text.ok()) return text.error();
  RunToken token;
  bool valid = text.value().size() == 2 * token.secret_.size();
  for (std::size_t i = 0; valid && i < token.secret_.size(); ++i) {
    const int high = DigitOf(text.value()[2 * i]);
    const int low = DigitOf(text.value()[2 * i + 1]);
    valid = high >= 0 && low >= 0;
    token.secret_[i] = static_cast<std::uint8_t>(high * 16 + low);
  }
  if (valid) return token;
  return Error{{path}, "found another text, expected the token of a run: 64 hexadecimal digits"};
}

bool RunToken::IsIn(const std::string& keys) {
  std::error_code failure;
  return std::filesystem::exists(PathIn(keys), failure);
}

Status RunToken::WriteTo(const std::string& keys) const {
  return WritePrivateFolder(keys + "/" + kTokenFolder, {{kTokenFile, ToHex(secret_)}});
}

std::string RunToken::Proof(const std::string& participant) const {
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> code{};
  unsigned int size = 0;
  HMAC(EVP_sha256(), secret_.data(), static_cast<int>(secret_.size()),
       reinterpret_cast<const unsigned char*>(participant.data()), participant.size(), code.data(), &size);
  return ToHex(std::span(code).first(size));
}

bool RunToken::Accepts(const std::string& participant, const std::string& proof) const {
  const std::string expected = Proof(participant);
  return !expected.empty() && proof.size() == expected.size() &&
         CRYPTO_memcmp(proof.data(), expected.data(), expected.size()) == 0;
}

}  // namespace troupe
