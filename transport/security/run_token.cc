#include "transport/security/run_token.h"

#include <fcntl.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/system_error.h"
#include "common/base/text.h"

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

namespace fs = std::filesystem;

// Most often the user has named a place where no folder can be.
Error FolderFailure(const fs::path& path) {
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EIO;
  Error error = SystemError("cannot make the folder", path.string());
  if (!full) error.code = ErrorCode::kBadInput;
  return error;
}

Status MakeFolders(const fs::path& folder) {
  if (folder.empty() || fs::is_directory(folder)) return {};
  if (Status above = MakeFolders(folder.parent_path()); !above.ok()) return above;
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return FolderFailure(folder);
  return {};
}

Status WriteFile(const fs::path& path, const std::string& content) {
  FileDescriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (file.get() < 0) return SystemError("cannot make the file", path.string());
  const bool written = WriteAll(file.get(), content);
  return written && file.Close() ? Status() : SystemError("cannot write the file", path.string());
}

// A folder is never replaced by a rename, unless it is empty.
Status Publish(const fs::path& temporary, const fs::path& folder) {
  if (std::rename(temporary.c_str(), folder.c_str()) == 0) return {};
  if (errno == ENOTEMPTY || errno == EEXIST || errno == ENOTDIR) {
    return Error{{folder.string()}, "exists already, and is not overwritten"};
  }
  return FolderFailure(folder);
}

// A folder that is removed, unless it has been published.
struct UnfinishedFolder {
  ~UnfinishedFolder() {
    if (!path.empty()) RemoveAll(path);
  }
  std::string path;
};

}  // namespace

Result<RunToken> RunToken::Make() {
  RunToken token;
  // Not by OpenSSL, which without memory for its start uses a lock that is not there.
  if (getentropy(token.secret_.data(), token.secret_.size()) == 0) return token;
  return SystemError("no random numbers for the token of a run");
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

Status WritePrivateFolder(const std::string& folder, const std::vector<PrivateFile>& files) {
  fs::path path(folder);
  if (!path.has_filename()) path = path.parent_path();  // written with a slash at its end
  if (Status above = MakeFolders(path.parent_path()); !above.ok()) return above;
  std::string temporary = path.string() + ".new-XXXXXX";
  if (mkdtemp(temporary.data()) == nullptr) return FolderFailure(path);
  UnfinishedFolder unfinished{std::move(temporary)};
  for (const PrivateFile& file : files) {
    if (Status status = WriteFile(fs::path(unfinished.path) / file.name, file.content); !status.ok()) return status;
  }
  if (Status status = Publish(unfinished.path, path); !status.ok()) return status;
  unfinished.path.clear();
  return {};
}

Result<std::string> ReadFileOfKeys(const std::string& path) {
  constexpr std::size_t kMax = 1'000'000;  // bytes
  Result<std::string> content = ReadWholeFile(path, kMax);
  if (content.ok()) return content;
  return Error{{path}, "cannot read: " + content.error().message};
}

}  // namespace troupe
