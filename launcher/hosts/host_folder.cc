#include "launcher/hosts/host_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

namespace troupe {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "troupe-host-";
constexpr std::string_view kRandom = "XXXXXX";
// Another host can take a folder for one of a killed process, in the moment before it is locked.
constexpr int kMostAttempts = 100;
constexpr const char* kNameFile = "name";  // of what the host serves
constexpr auto kEndPeriod = std::chrono::milliseconds(10);
constexpr int kEndPeriods = 200;  // until a host that is killed has ended

// Folders of other names may belong to a process that does not lock them.
bool IsName(std::string_view name) {
  if (!name.starts_with(kPrefix)) return false;
  name.remove_prefix(kPrefix.size());
  const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
  return digits > 0 && name.size() == digits + 1 + kRandom.size() && name[digits] == '-';
}

// -1 for anything but a folder, and for a link to one.
int OpenFolder(const fs::path& path) {
  return open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

// False if another folder or none has this path by now.
bool IsAt(int folder, const fs::path& path) {
  struct stat opened = {};
  struct stat found = {};
  return fstat(folder, &opened) == 0 && lstat(path.c_str(), &found) == 0 && opened.st_dev == found.st_dev &&
         opened.st_ino == found.st_ino;
}

bool IsOwn(int folder) {
  struct stat state = {};
  return fstat(folder, &state) == 0 && state.st_uid == geteuid();
}

void DeleteIfItsHostWasKilled(const fs::path& path) {
  const int folder = OpenFolder(path);
  if (folder < 0) return;
  std::error_code ignored;
  if (IsOwn(folder) && flock(folder, LOCK_EX | LOCK_NB) == 0 && IsAt(folder, path)) fs::remove_all(path, ignored);
  close(folder);
}

// Of the process with this folder. REQUIRES: IsName
pid_t ProcessOf(const fs::path& path) {
  return static_cast<pid_t>(std::atol(path.filename().c_str() + kPrefix.size()));
}

void EndHostThatServes(const std::string& name, const fs::path& path) {
  std::string served;
  std::ifstream file(path / kNameFile);
  if (!std::getline(file, served) || served != name) return;
  const int folder = OpenFolder(path);
  if (folder < 0) return;
  // The lock shows that the process lives, and has not given its number to another one.
  const bool lives =
      IsOwn(folder) && IsAt(folder, path) && flock(folder, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  const pid_t process = ProcessOf(path);
  if (lives && process > 1 && process != getpid() && kill(process, SIGKILL) == 0) {
    for (int i = 0; i < kEndPeriods && flock(folder, LOCK_EX | LOCK_NB) != 0; ++i)
      std::this_thread::sleep_for(kEndPeriod);
  }
  close(folder);
  DeleteIfItsHostWasKilled(path);
}

void DeleteFoldersOfKilledHosts(const fs::path& parent) {
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, failure)) {
    if (IsName(entry.path().filename().string())) DeleteIfItsHostWasKilled(entry.path());
  }
}

}  // namespace

HostFolder::HostFolder() {
  std::error_code failure;
  const fs::path parent = fs::temp_directory_path(failure);
  if (failure) return;
  DeleteFoldersOfKilledHosts(parent);
  const std::string pattern = (parent / kPrefix).string() + std::to_string(getpid()) + "-" + std::string(kRandom);
  for (int attempt = 0; attempt < kMostAttempts && path_.empty(); ++attempt) {
    std::string path = pattern;
    if (mkdtemp(path.data()) == nullptr) return;
    const int folder = OpenFolder(path);
    // Where a file system has no locks, no other host has one either, and none deletes the folder.
    while (folder >= 0 && flock(folder, LOCK_EX) != 0 && errno == EINTR) continue;
    if (folder >= 0 && IsAt(folder, path)) {
      path_ = std::move(path);
      lock_ = folder;
    } else if (folder >= 0) {
      close(folder);
    }
  }
}

void HostFolder::TakeOver(const std::string& name) {
  if (path_.empty()) return;
  std::error_code failure;
  std::vector<fs::path> others;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(path_).parent_path(), failure)) {
    if (IsName(entry.path().filename().string()) && entry.path() != path_) others.push_back(entry.path());
  }
  for (const fs::path& other : others) EndHostThatServes(name, other);
  std::ofstream(fs::path(path_) / kNameFile) << name << "\n";
}

HostFolder::~HostFolder() {
  if (path_.empty()) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  close(lock_);
}

}  // namespace troupe
