// RunToken: a secret that the processes and tools of a run share on a network that other users can use as well, but not
// read or forge packets on: the loopback interface. A participant proves that it has the token in the announcement of
// each of its writers. The proof is of its own identity, so that it is of no use to a participant that copies it.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

class RunToken {
 public:
  // At random. The error is a lack of random numbers.
  static Result<RunToken> Make();

  // The token in a folder of keys, which WriteTo has written.
  static Result<RunToken> ReadFrom(const std::string& keys);
  static bool IsIn(const std::string& keys);
  // Mode 0600, in a folder of mode 0700.
  Status WriteTo(const std::string& keys) const;

  // `participant`: the text of its identity on the network. 64 hexadecimal digits: HMAC-SHA-256 (RFC 2104).
  std::string Proof(const std::string& participant) const;
  bool Accepts(const std::string& participant, const std::string& proof) const;

  bool operator==(const RunToken&) const = default;

 private:
  std::array<std::uint8_t, 32> secret_{};
};

// The name of the token's folder in a folder of keys.
inline constexpr const char* kTokenFolder = "token";
inline constexpr const char* kTokenFile = "token.hex";

// A folder of secrets: made whole or not at all, for its owner only.

struct PrivateFile {
  std::string name;
  std::string content;
};

// Writes the files (mode 0600) into a new folder (0700), which appears under its name when it is complete. Missing
// folders above it are made too (0700). Fails if a folder with files, or anything else, has that name already.
Status WritePrivateFolder(const std::string& folder, const std::vector<PrivateFile>& files);

// The content of a small file of such a folder.
Result<std::string> ReadFileOfKeys(const std::string& path);

}  // namespace troupe
