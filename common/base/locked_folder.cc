#include "common/base/locked_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "common/base/file.h"

namespace troupe {
namespace {

// Another process can take a new folder for an abandoned one, in the moment before it is locked.
constexpr int kMaxAttempts = 100;

// -1 for anything but a folder, and for a link to one.
int OpenFolder(const std::filesystem::path& path) {
  return open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

// False if another folder or none has this path by now.
bool IsAt(int folder, const std::filesystem::path& path) {
  struct stat opened = {};
  struct stat found = {};
  return fstat(folder, &opened) == 0 && lstat(path.c_str(), &found) == 0 && opened.st_dev == found.st_dev &&
         opened.st_ino == found.st_ino;
}

bool IsOwn(int folder) {
  struct stat state = {};
  return fstat(folder, &state) == 0 && state.st_uid == geteuid();
}

}  // namespace

LockedFolder LockedFolder::Make(const std::string& pattern) {
  LockedFolder made;
  for (int attempt = 0; attempt < kMaxAttempts && made.path_.empty(); ++attempt) {
    std::string path = pattern;
    if (mkdtemp(path.data()) == nullptr) return made;
    const int folder = OpenFolder(path);
    // Where a file system has no locks, no other process has one either, and none deletes the folder.
    while (folder >= 0 && flock(folder, LOCK_EX) != 0 && errno == EINTR) continue;
    if (folder >= 0 && IsAt(folder, path)) {
      made.path_ = std::move(path);
      made.lock_ = folder;
    } else if (folder >= 0) {
      close(folder);
    }
  }
  return made;
}

LockedFolder::LockedFolder(LockedFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), lock_(std::exchange(other.lock_, -1)) {}

LockedFolder& LockedFolder::operator=(LockedFolder&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(lock_, other.lock_);
  return *this;
}

LockedFolder::~LockedFolder() {
  if (path_.empty()) return;
  RemoveAll(path_);
  close(lock_);
}

bool LockedFolder::IsHeld(const std::filesystem::path& path) {
  const int folder = OpenFolder(path);
  if (folder < 0) return false;
  const bool is_held =
      IsOwn(folder) && IsAt(folder, path) && flock(folder, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(folder);
  return is_held;
}

void LockedFolder::DeleteIfAbandoned(const std::filesystem::path& path) {
  const int folder = OpenFolder(path);
  if (folder < 0) return;
  std::error_code ignored;
  // Only if the path still leads to the locked folder: another process may have made a new one of this name meanwhile.
  if (IsOwn(folder) && flock(folder, LOCK_EX | LOCK_NB) == 0 && IsAt(folder, path)) {
    std::filesystem::remove_all(path, ignored);
  }
  close(folder);
}

}  // namespace troupe
