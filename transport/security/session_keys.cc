#include "transport/security/session_keys.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/locked_folder.h"
#include "common/base/paths.h"
#include "common/base/system_error.h"
#include "common/run/run_settings.h"
#include "transport/security/certificate.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

fs::path PathOfSessions() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && *runtime != '\0') return fs::path(runtime) / "troupe";
  std::error_code failure;
  const fs::path temporary = fs::temp_directory_path(failure);
  return (failure ? fs::path("/tmp") : temporary) / ("troupe-" + std::to_string(getuid()));
}

// Anyone could have made it first, where the folder above is writable for all.
Status CheckPrivate(const fs::path& folder) {
  struct stat state = {};
  // lstat, so that a link to another folder is refused, too.
  if (lstat(folder.c_str(), &state) != 0) return SystemError(folder.string());
  const bool is_private = S_ISDIR(state.st_mode) && state.st_uid == getuid() && (state.st_mode & 077) == 0;
  if (is_private) return {};
  return Failure(folder.string() +
                 ": found a file or a folder that others own or can read, expected a folder of mode " +
                 "0700 of this user, for the keys of runs");
}

std::string Prefix(std::uint32_t domain) {
  return std::to_string(domain) + "-";
}

// Its folder; empty if the session has none.
std::string KeysOf(std::uint32_t domain, const std::string& session) {
  const fs::path folder = PathOfSessions();
  if (!CheckPrivate(folder).ok()) return {};
  std::error_code failure;
  const fs::path keys = fs::canonical(folder / (Prefix(domain) + session), failure);
  return failure ? std::string() : keys.string();
}

constexpr std::string_view kPrefix = "keys-";  // then the process id of the maker, for people

void DeleteKeysOfKilledProcesses(const fs::path& sessions) {
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(sessions, failure)) {
    if (entry.path().filename().string().starts_with(kPrefix)) LockedFolder::DeleteIfAbandoned(entry.path());
  }
}

}  // namespace

Result<std::string> SessionsFolder() {
  const fs::path folder = PathOfSessions();
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    return SystemError("cannot make " + folder.string() + ", for the keys of runs");
  }
  if (Status status = CheckPrivate(folder); !status.ok()) return status.error();
  return folder.string();
}

Result<PublishedKeys> PublishedKeys::Publish(std::uint32_t domain, const std::string& session,
                                             const std::string& keys) {
  std::error_code failure;
  if (keys.empty()) {
    fs::remove(PathOfSessions() / (Prefix(domain) + session), failure);
    return PublishedKeys();
  }
  Result<std::string> folder = SessionsFolder();
  if (!folder.ok()) return folder.error();
  DeleteNamesOfDeletedKeys();
  const std::string link = folder.value() + "/" + Prefix(domain) + session;
  const fs::path target = fs::absolute(keys, failure);
  const std::string fresh = link + ".new-" + std::to_string(getpid());
  fs::remove(fresh, failure);
  // Made under another name and renamed: a reader sees the old keys or the new ones, never none.
  fs::create_symlink(target, fresh, failure);
  if (!failure) fs::rename(fresh, link, failure);
  if (failure) return Failure("cannot make " + link + ": " + failure.message());
  PublishedKeys published;
  published.link_ = link;
  return published;
}

void DeleteNamesOfDeletedKeys() {
  const fs::path folder = PathOfSessions();
  if (!CheckPrivate(folder).ok()) return;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure)) {
    if (!entry.is_symlink(failure) || fs::status(entry.path(), failure).type() != fs::file_type::not_found) continue;
    fs::remove(entry.path(), failure);
  }
}

PublishedKeys::PublishedKeys(PublishedKeys&& other) noexcept : link_(std::exchange(other.link_, {})) {}

PublishedKeys& PublishedKeys::operator=(PublishedKeys&& other) noexcept {
  std::swap(link_, other.link_);
  return *this;
}

PublishedKeys::~PublishedKeys() {
  if (!link_.empty()) unlink(link_.c_str());
}

std::vector<SessionKeys> FindSessionKeys(std::uint32_t domain) {
  const fs::path folder = PathOfSessions();
  std::vector<SessionKeys> found;
  if (!CheckPrivate(folder).ok()) return found;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    const std::string prefix = Prefix(domain);
    if (!name.starts_with(prefix) || !entry.is_symlink(failure)) continue;
    const std::string session = name.substr(prefix.size());
    const std::string keys = KeysOf(domain, session);
    if (!keys.empty()) found.push_back({session, keys});
  }
  std::sort(found.begin(), found.end(),
            [](const SessionKeys& a, const SessionKeys& b) { return a.session < b.session; });
  return found;
}

Result<ParticipantKeys> FindKeys(const std::string& security, std::uint32_t domain, const std::string& session,
                                 const Role& role) {
  if (security == kSecurityOff) return ParticipantKeys();
  const bool published = security == kSecurityAuto || security == kSecurityOn;
  const std::string keys = published ? KeysOf(domain, session) : security;
  if (keys.empty() && security == kSecurityOn) {
    return Failure("--security on: no run of session '" + session + "' has published keys in " +
                   PathOfSessions().string());
  }
  if (keys.empty()) return ParticipantKeys();
  if (RunToken::IsIn(keys)) {
    Result<RunToken> token = RunToken::ReadFrom(keys);
    if (!token.ok()) return token.error();
    return ParticipantKeys{{}, std::move(token).value()};
  }
  const std::string enclave = keys + "/" + KeyFolder(role);
  if (Status status = CheckEnclave(enclave); !status.ok()) return status.error();
  // DDS Security would say only that a certificate is not valid, and peers would wait for one another.
  const Result<std::string> certificate = ReadFileOfKeys(enclave + "/" + kCertificateFile);
  if (!certificate.ok()) return certificate.error();
  const Result<Validity> validity = ValidityOfCertificate(certificate.value());
  const Status clock =
      validity.ok() ? CheckClock(validity.value(), TimeOfClock()) : Status();  // DDS names other faults
  if (!clock.ok()) return clock.error();
  return ParticipantKeys{enclave, std::nullopt};
}

bool IsAgentName(const std::string& name) {
  constexpr std::size_t kMaxLength = 64;
  return !name.empty() && name.size() <= kMaxLength &&
         name.find_first_not_of("0123456789abcdefghijklmnopqrstuvwxyz") == std::string::npos;
}

std::string KeyFolder(const Role& role) {
  switch (role.kind) {
    case Role::Kind::kService:
      return "service";
    case Role::Kind::kAgent:
      return "agents/" + role.agent_name;
    case Role::Kind::kOperator:
      return "operator";
    case Role::Kind::kObserver:
      return "observer";
  }
  return {};
}

Result<RunKeysFolder> RunKeysFolder::Make() {
  const Result<std::string> sessions = SessionsFolder();
  if (!sessions.ok()) return sessions.error();
  DeleteKeysOfKilledProcesses(sessions.value());
  RunKeysFolder keys;
  keys.folder_ =
      LockedFolder::Make(sessions.value() + "/" + std::string(kPrefix) + std::to_string(getpid()) + "-XXXXXX");
  if (keys.path().empty())
    return SystemError("cannot make a folder in " + sessions.value() + ", for the keys of a run");
  return keys;
}

Result<RunKeysFolder> RunKeysFolder::MakeWithToken() {
  Result<RunKeysFolder> folder = Make();
  if (!folder.ok()) return folder;
  const Result<RunToken> token = RunToken::Make();
  if (!token.ok()) return token.error();
  if (const Status written = token.value().WriteTo(folder.value().path()); !written.ok()) return written.error();
  return folder;
}

RunKeysFolder::RunKeysFolder(RunKeysFolder&& other) noexcept = default;
RunKeysFolder& RunKeysFolder::operator=(RunKeysFolder&& other) noexcept = default;

RunKeysFolder::~RunKeysFolder() {
  if (path().empty()) return;
  folder_ = {};
  try {
    DeleteNamesOfDeletedKeys();      // the service may have been killed at its end
  } catch (const std::exception&) {  // without memory the next run deletes them
  }
}

}  // namespace troupe
