#include "transport/security/run_token.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/sha.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <system_error>

#include "common/base/hexadecimal.h"
#include "transport/security/private_folder.h"

namespace troupe {
namespace {

std::string PathIn(const std::string& keys) {
  return keys + "/" + kTokenFolder + "/" + kTokenFile;
}

using Digest = std::array<std::uint8_t, SHA256_DIGEST_LENGTH>;

// The pads of RFC 2104.
constexpr std::uint8_t kInnerPad = 0x36;
constexpr std::uint8_t kOuterPad = 0x5c;

// OpenSSL's functions for any hash and for HMAC fill 2 MiB of each process at their first call, a fifth of an agent's
// memory. Those for SHA-256 alone do not, and are deprecated.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

// The hash of the key, filled up to a block and combined with the pad, and of the text.
Digest HashWithPad(std::span<const std::uint8_t> key, std::uint8_t pad, std::span<const std::uint8_t> text) {
  std::array<std::uint8_t, SHA256_CBLOCK> block{};
  std::copy(key.begin(), key.end(), block.begin());
  for (std::uint8_t& byte : block) byte ^= pad;
  Digest digest{};
  SHA256_CTX hash;
  SHA256_Init(&hash);
  SHA256_Update(&hash, block.data(), block.size());
  SHA256_Update(&hash, text.data(), text.size());
  SHA256_Final(digest.data(), &hash);
  return digest;
}

#pragma GCC diagnostic pop

}  // namespace

Result<RunToken> RunToken::Make() {
  RunToken token;
  if (RAND_bytes(token.secret_.data(), static_cast<int>(token.secret_.size())) == 1) return token;
  return Failure("no random numbers for the token of a run");
}

Result<RunToken> RunToken::ReadFrom(const std::string& keys) {
  const std::string path = PathIn(keys);
  const Result<std::string> text = ReadFileOfKeys(path);
  if (!text.ok()) return text.error();
  RunToken token;
  const std::optional<std::string> secret = FromHexadecimal(text.value());
  if (secret && secret->size() == token.secret_.size()) {
    std::copy(secret->begin(), secret->end(), token.secret_.begin());
    return token;
  }
  return Error{{path}, "found another text, expected the token of a run: 64 hexadecimal digits"};
}

bool RunToken::IsIn(const std::string& keys) {
  std::error_code failure;
  return std::filesystem::exists(PathIn(keys), failure);
}

Status RunToken::WriteTo(const std::string& keys) const {
  return WritePrivateFolder(keys + "/" + kTokenFolder,
                            {{kTokenFile, ToHexadecimal(std::as_bytes(std::span(secret_)))}});
}

std::string RunToken::Proof(const std::string& participant) const {
  const auto* text = reinterpret_cast<const std::uint8_t*>(participant.data());
  const Digest inner = HashWithPad(secret_, kInnerPad, std::span(text, participant.size()));
  const Digest outer = HashWithPad(secret_, kOuterPad, inner);
  return ToHexadecimal(std::as_bytes(std::span(outer)));
}

bool RunToken::Accepts(const std::string& participant, const std::string& proof) const {
  const std::string expected = Proof(participant);
  return !expected.empty() && proof.size() == expected.size() &&
         CRYPTO_memcmp(proof.data(), expected.data(), expected.size()) == 0;
}

}  // namespace troupe
