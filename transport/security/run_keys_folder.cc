#include "transport/security/run_keys_folder.h"

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

#include "transport/security/run_token.h"
#include "transport/security/session_keys.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "keys-";  // then the process id of the maker

bool IsRunning(pid_t pid) {
  return kill(pid, 0) == 0 || errno != ESRCH;
}

void DeleteKeysOfKilledProcesses(const fs::path& sessions) {
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(sessions, failure)) {
    const std::string name = entry.path().filename().string();
    pid_t pid = 0;
    if (!name.starts_with(kPrefix)) continue;
    const auto parsed = std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), pid);
    if (parsed.ec == std::errc() && pid > 0 && !IsRunning(pid)) fs::remove_all(entry.path(), failure);
  }
}

}  // namespace

Result<RunKeysFolder> RunKeysFolder::Make() {
  const Result<std::string> sessions = SessionsFolder();
  if (!sessions.ok()) return sessions.error();
  DeleteKeysOfKilledProcesses(sessions.value());
  std::string path = sessions.value() + "/" + std::string(kPrefix) + std::to_string(getpid()) + "-XXXXXX";
  if (mkdtemp(path.data()) == nullptr) return Failure("cannot make " + path + ": " + std::strerror(errno));
  RunKeysFolder folder;
  folder.path_ = std::move(path);
  return folder;
}

Result<RunKeysFolder> RunKeysFolder::MakeWithToken() {
  Result<RunKeysFolder> folder = Make();
  if (!folder.ok()) return folder;
  const Result<RunToken> token = RunToken::Make();
  if (!token.ok()) return token.error();
  if (const Status written = token.value().WriteTo(folder.value().path()); !written.ok()) return written.error();
  return folder;
}

RunKeysFolder::RunKeysFolder(RunKeysFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}

RunKeysFolder& RunKeysFolder::operator=(RunKeysFolder&& other) noexcept {
  std::swap(path_, other.path_);
  return *this;
}

RunKeysFolder::~RunKeysFolder() {
  std::error_code ignored;
  if (path_.empty()) return;
  fs::remove_all(path_, ignored);
  DeleteNamesOfDeletedKeys();  // the service may have been killed at its end
}

}  // namespace troupe
