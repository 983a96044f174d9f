#include "launcher/supervise/run_keys.h"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/protocol/agent_name.h"
#include "common/security/session_keys.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "keys-";  // then the process id of the launcher

bool IsRunning(pid_t pid) {
  return kill(pid, 0) == 0 || errno != ESRCH;
}

void DeleteKeysOfKilledLaunchers(const fs::path& sessions) {
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(sessions, failure)) {
    const std::string name = entry.path().filename().string();
    pid_t pid = 0;
    if (!name.starts_with(kPrefix)) continue;
    const auto parsed = std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), pid);
    if (parsed.ec == std::errc() && pid > 0 && !IsRunning(pid)) fs::remove_all(entry.path(), failure);
  }
}

Result<std::string> MakeKeysFolder() {
  const Result<std::string> sessions = SessionsFolder();
  if (!sessions.ok()) return sessions.error();
  DeleteKeysOfKilledLaunchers(sessions.value());
  std::string folder = sessions.value() + "/" + std::string(kPrefix) + std::to_string(getpid()) + "-XXXXXX";
  if (mkdtemp(folder.data()) == nullptr) return Failure("cannot make " + folder + ": " + std::strerror(errno));
  return folder;
}

}  // namespace

Result<RunKeys> RunKeys::Make(const NetworkSettings& network) {
  RunKeys keys;
  const bool is_local = network.network_interface == kLoopbackInterface;
  if (network.security == kSecurityOff || (network.security == kSecurityAuto && is_local)) return keys;
  if (network.security != kSecurityAuto && network.security != kSecurityOn) {
    std::error_code failure;
    keys.folder_ = fs::absolute(network.security, failure).lexically_normal().string();
    return keys;
  }
  Result<std::string> folder = MakeKeysFolder();
  if (!folder.ok()) return folder.error();
  keys.folder_ = std::move(folder).value();
  keys.temporary_ = true;
  Result<KeyAuthority> authority = KeyAuthority::Create(KeyAuthority::kEphemeralLifetime);
  if (!authority.ok()) return authority.error();
  keys.authority_.emplace(std::move(authority).value());
  for (const Role& role : {Role::Service(), Role::Operator(), Role::Observer()}) {
    const Status written = keys.authority_->WriteIdentity(keys.folder_ + "/" + KeyFolder(role), role);
    if (!written.ok()) return written.error();
  }
  return keys;
}

RunKeys::RunKeys(RunKeys&& other) noexcept
    : folder_(std::exchange(other.folder_, {})),
      temporary_(std::exchange(other.temporary_, false)),
      authority_(std::exchange(other.authority_, std::nullopt)) {}

RunKeys& RunKeys::operator=(RunKeys&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(temporary_, other.temporary_);
  std::swap(authority_, other.authority_);
  return *this;
}

RunKeys::~RunKeys() {
  std::error_code ignored;
  if (temporary_) fs::remove_all(folder_, ignored);
}

Result<std::string> RunKeys::ForService(Host& host) const {
  return PlaceOn(host, {Role::Service(), Role::Operator(), Role::Observer()});
}

Result<std::string> RunKeys::ForAgent(Host& host, const std::vector<std::string>& robots) const {
  const Role role = Role::Agent(AgentName(robots));
  const std::string enclave = folder_ + "/" + KeyFolder(role);
  std::error_code failure;
  if (authority_ && !fs::exists(enclave, failure)) {
    if (const Status written = authority_->WriteIdentity(enclave, role); !written.ok()) return written.error();
  }
  return PlaceOn(host, {role});
}

Result<std::string> RunKeys::PlaceOn(Host& host, const std::vector<Role>& roles) const {
  if (folder_.empty()) return std::string(kSecurityOff);
  std::string there = folder_;
  for (const Role& role : roles) {
    const std::string enclave = KeyFolder(role);
    std::error_code failure;
    // A folder of the user's may be without the keys of tools; a missing one of a process is an error of that process.
    if (!fs::is_directory(folder_ + "/" + enclave, failure)) continue;
    Result<std::string> placed = host.PlaceKeys(folder_, enclave);
    if (!placed.ok()) return placed;
    there = std::move(placed).value();
  }
  return there;
}

}  // namespace troupe
