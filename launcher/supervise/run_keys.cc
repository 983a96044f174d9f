#include "launcher/supervise/run_keys.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "transport/protocol/message_texts.h"
#include "transport/security/run_token.h"

namespace troupe {

namespace fs = std::filesystem;

// The words of --security, or a folder. auto means a token where all processes are on the loopback interface, and
// identities elsewhere.
Result<RunKeys> RunKeys::Make(const NetworkSettings& network) {
  RunKeys keys;
  if (network.security == kSecurityOff) return keys;
  if (network.security != kSecurityAuto && network.security != kSecurityOn) {
    std::error_code failure;
    keys.folder_ = fs::absolute(network.security, failure).lexically_normal().string();
    keys.token_ = RunToken::IsIn(keys.folder_);
    return keys;
  }
  keys.token_ = network.security == kSecurityAuto && network.network_interface == kLoopbackInterface;
  Result<RunKeysFolder> folder = keys.token_ ? RunKeysFolder::MakeWithToken() : RunKeysFolder::Make();
  if (!folder.ok()) return folder.error();
  keys.own_ = std::move(folder).value();
  keys.folder_ = keys.own_.path();
  if (keys.token_) return keys;
  Result<KeyAuthority> authority = KeyAuthority::Create(KeyAuthority::kEphemeralLifetime);
  if (!authority.ok()) return authority.error();
  keys.authority_.emplace(std::move(authority).value());
  for (const Role& role : {Role::Service(), Role::Operator(), Role::Observer()}) {
    const Status written = keys.authority_->WriteIdentity(keys.folder_ + "/" + KeyFolder(role), role);
    if (!written.ok()) return written.error();
  }
  return keys;
}

Result<std::string> RunKeys::ForService(Host& host) const {
  if (token_) return PlaceOn(host, {kTokenFolder});
  return PlaceOn(host, {KeyFolder(Role::Service()), KeyFolder(Role::Operator()), KeyFolder(Role::Observer())});
}

// An identity is written once for each set of robots: a restarted agent is the same party for the others.
Result<std::string> RunKeys::ForAgent(Host& host, const std::vector<std::string>& robots) const {
  if (token_) return PlaceOn(host, {kTokenFolder});
  const Role role = Role::Agent(AgentName(robots));
  const std::string enclave = folder_ + "/" + KeyFolder(role);
  std::error_code failure;
  if (authority_ && !fs::exists(enclave, failure)) {
    if (const Status written = authority_->WriteIdentity(enclave, role); !written.ok()) return written.error();
  }
  return PlaceOn(host, {KeyFolder(role)});
}

Result<std::string> RunKeys::PlaceOn(Host& host, const std::vector<std::string>& folders) const {
  if (folder_.empty()) return std::string(kSecurityOff);
  std::string there = folder_;
  for (const std::string& name : folders) {
    std::error_code failure;
    // A folder of the user's may be without the keys of tools; a missing one of a process is an error of that process.
    if (!fs::is_directory(folder_ + "/" + name, failure)) continue;
    Result<std::string> placed = host.PlaceKeys(folder_, name);
    if (!placed.ok()) return placed;
    there = std::move(placed).value();
  }
  return there;
}

}  // namespace troupe
