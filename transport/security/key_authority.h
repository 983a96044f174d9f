// KeyAuthority: the root of trust of runs. Participants that it has given keys accept each other and no others, and
// each may only do what its role needs.
//
// One authority for identities and permissions, for one run (in memory, thrown away with it) or for a site (saved, with
// its own protection). Its private key can make participants of any role.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "transport/security/session_keys.h"
#include "troupe/result.h"

namespace troupe {

struct CertifiedKey;

class KeyAuthority {
 public:
  static constexpr std::chrono::days kLifetime{3653};         // of an authority that is saved
  static constexpr std::chrono::days kEphemeralLifetime{90};  // of one that ends with its run

  // A new one, in memory only. Its keys count from a day ago, because hosts' clocks differ, until `lifetime` from now.
  static Result<KeyAuthority> Create(std::chrono::seconds lifetime = kLifetime);
  // What Save has written. Fails if it is damaged or has expired.
  static Result<KeyAuthority> Load(const std::string& folder);

  KeyAuthority(KeyAuthority&& other) noexcept;
  KeyAuthority& operator=(KeyAuthority&& other) noexcept;
  ~KeyAuthority();

  // Both write a new folder (mode 0700, its files 0600) that appears whole or not at all, and with it missing folders
  // above. They overwrite nothing: a folder with files is an error.
  Status Save(const std::string& folder) const;
  // Makes the keys of one participant: a folder with the files of common/base/paths.h.
  // REQUIRES: the agent's name is an IsAgentName
  Status WriteIdentity(const std::string& folder, const Role& role) const;

 private:
  explicit KeyAuthority(std::unique_ptr<const CertifiedKey> key, std::string governance);

  std::unique_ptr<const CertifiedKey> key_;
  std::string governance_;  // signed; kept, so that all participants of an authority have the same rules
};

}  // namespace troupe
