#include "common/base/file.h"

#include <dirent.h>
#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "common/base/identity.h"
#include "common/base/system_error.h"

namespace troupe {
namespace {

constexpr std::size_t kGrowth = std::size_t{64} * 1024;  // bytes
// A link in /proc/self/fd or a device may have changed since it was looked at: then the call fails and does not wait.
constexpr int kNeverWait = O_CLOEXEC | O_NOCTTY | O_NONBLOCK;

const char* KindOf(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a named pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

Error WrongKind(const std::string& path, mode_t mode, const char* expected) {
  return {{path}, std::string("it is ") + KindOf(mode) + ", expected " + expected};
}

// As standard output, to which another program listens already.
bool IsOpenPipe(const std::string& path) {
  struct statfs system = {};
  return statfs(path.c_str(), &system) == 0 && system.f_type == PIPEFS_MAGIC;
}

// Not that of a folder: open tells it.
Status CheckKindToWrite(const std::string& path) {
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) return {};
  if (S_ISCHR(status.st_mode) || (S_ISFIFO(status.st_mode) && IsOpenPipe(path))) return {};
  return WrongKind(path, status.st_mode, "a regular file");
}

namespace fs = std::filesystem;

bool RemoveIn(int folder, const char* name) noexcept;

// True if an entry was removed.
bool RemoveEntries(int folder) noexcept {
  alignas(dirent64) std::array<char, 4096> entries;  // on the stack: readdir would need memory
  bool removed = false;
  for (;;) {
    const auto size = getdents64(folder, reinterpret_cast<dirent64*>(entries.data()), entries.size());
    if (size <= 0) return removed;
    for (std::size_t at = 0; at < static_cast<std::size_t>(size);) {
      const auto* const entry = reinterpret_cast<const dirent64*>(entries.data() + at);
      at += entry->d_reclen;
      const std::string_view name = entry->d_name;
      if (name != "." && name != "..") removed = RemoveIn(folder, entry->d_name) || removed;
    }
  }
}

bool RemoveIn(int folder, const char* name) noexcept {
  if (unlinkat(folder, name, 0) == 0) return true;
  const FileDescriptor inner(openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (inner.get() < 0) return false;
  // Entries are removed while they are listed, so that a folder is read again until nothing is left to remove.
  while (RemoveEntries(inner.get())) lseek(inner.get(), 0, SEEK_SET);  // a removal may hide an entry from the reading
  return unlinkat(folder, name, AT_REMOVEDIR) == 0;
}

constexpr std::size_t kMaxFileName = 255;  // bytes

// A name that no program looks for.
fs::path NameBeside(const fs::path& path) {
  const std::string ending = "." + std::to_string(MakeRandomId());
  const std::string name = "." + path.filename().string();
  return path.parent_path() / (name.substr(0, kMaxFileName - ending.size()) + ending);
}

// The path of the file that is written, which is no link; its file may be missing.
Result<fs::path> TargetOf(const std::string& named) {
  constexpr int kMaxLinks = 40;  // as in Linux
  std::error_code error;
  fs::path path = fs::absolute(named, error);
  for (int links = 0; !error && fs::is_symlink(path, error); ++links) {
    if (links == kMaxLinks) error = std::make_error_code(std::errc::too_many_symbolic_link_levels);
    if (!error) path = path.parent_path() / fs::read_symlink(path, error);
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    return Error{{named}, "cannot write: " + error.message(), ErrorCode::kOutputFailed};
  }
  return path;
}

}  // namespace

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

int FileDescriptor::Release() {
  return std::exchange(descriptor_, -1);
}

bool FileDescriptor::Close() {
  const int descriptor = Release();
  return descriptor < 0 || close(descriptor) == 0;
}

Error FileError(const std::string& path, ErrorCode code) {
  return {{path}, std::strerror(errno), code};
}

Result<FileDescriptor> OpenToRead(const std::string& path) {
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0) return FileError(path);
  if (!S_ISREG(status.st_mode)) return WrongKind(path, status.st_mode, "a regular file");
  FileDescriptor file(open(path.c_str(), O_RDONLY | kNeverWait));
  if (file.get() < 0) return FileError(path);
  return file;
}

Result<FileDescriptor> OpenToWrite(const std::string& path, int flags) {
  if (Status wrong = CheckKindToWrite(path); !wrong.ok()) return wrong.error();
  FileDescriptor file(open(path.c_str(), O_WRONLY | O_CREAT | flags | kNeverWait, 0666));
  if (file.get() < 0) return FileError(path);
  fcntl(file.get(), F_SETFL, fcntl(file.get(), F_GETFL) & ~O_NONBLOCK);  // of a pipe or a terminal: writes wait
  return file;
}

Status CheckWritable(const std::string& path) {
  if (Status wrong = CheckKindToWrite(path); !wrong.ok()) return wrong;
  FileDescriptor made(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | kNeverWait, 0666));
  if (made.get() >= 0) {
    unlink(path.c_str());
    return {};
  }
  if (errno != EEXIST) return FileError(path);
  Result<FileDescriptor> file = OpenToWrite(path);  // perhaps the missing target of a link, which it makes
  return file.ok() ? Status() : file.error();
}

Result<std::string> ReadToEnd(const FileDescriptor& file, const std::string& path, std::size_t most) {
  struct stat status = {};
  if (fstat(file.get(), &status) != 0) return FileError(path);
  const auto too_long = [&](const std::string& size) {
    return Error{{path}, "found " + size + " bytes, expected at most " + std::to_string(most)};
  };
  const auto stated = static_cast<std::size_t>(status.st_size);
  if (stated > most) return too_long(std::to_string(stated));
  std::string text;
  std::size_t length = 0;
  for (;;) {
    // One byte more than stated: the read that finds the end needs no second buffer.
    if (length == text.size()) text.resize(length == 0 ? stated + 1 : length + std::max(kGrowth, length / 2));
    const ssize_t count = read(file.get(), text.data() + length, text.size() - length);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return FileError(path);
    if (count == 0) break;
    length += static_cast<std::size_t>(count);
    if (length > most) return too_long("more than " + std::to_string(most));
  }
  if (length < stated) return Error{{path}, "it has become shorter meanwhile", ErrorCode::kFailure};
  text.resize(length);
  return text;
}

Result<std::string> ReadWholeFile(const std::string& path, std::size_t most) {
  const Result<FileDescriptor> file = OpenToRead(path);
  if (!file.ok()) return file.error();
  return ReadToEnd(file.value(), path, most);
}

bool WriteAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) {  // as of a socket that is read from, too, without waiting
      pollfd waited{descriptor, POLLOUT, 0};
      if (poll(&waited, 1, -1) < 0 && errno != EINTR) return false;
      continue;
    }
    if (count == 0) errno = EIO;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

Result<FileReplacement> FileReplacement::Prepare(const std::string& named, std::string_view content) {
  const Result<fs::path> path = TargetOf(named);
  if (!path.ok()) return path.error();
  struct stat old = {};
  const bool exists = stat(path.value().c_str(), &old) == 0;
  if (exists && !S_ISREG(old.st_mode)) return Error{{named}, "cannot write: it is not a file, expected a regular file"};
  if (exists && access(path.value().c_str(), W_OK) != 0)
    return SystemError("cannot write", named, ErrorCode::kOutputFailed);
  // All memory first: from the file's creation on the replacement removes it.
  FileReplacement replacement;
  replacement.named_ = named;
  replacement.path_ = path.value().string();
  std::string temporary = NameBeside(path.value()).string();
  FileDescriptor file(open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.get() < 0) return SystemError("cannot write", named, ErrorCode::kOutputFailed);
  replacement.temporary_ = std::move(temporary);
  // The owner first: a change of it may clear permissions. Only root can give a file away.
  if (exists && (old.st_uid != geteuid() || old.st_gid != getegid())) {
    static_cast<void>(fchown(file.get(), old.st_uid, old.st_gid) == 0);
  }
  // fsync before the rename: otherwise a loss of power may leave the new name with no content.
  const bool written = WriteAll(file.get(), content) && (!exists || fchmod(file.get(), old.st_mode & 07777) == 0) &&
                       fsync(file.get()) == 0;
  if (written && file.Close()) return replacement;
  return SystemError("cannot write", named, ErrorCode::kOutputFailed);
}

FileReplacement::FileReplacement(FileReplacement&& other) noexcept
    : named_(std::move(other.named_)),
      path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, std::string())) {}

void RemoveAll(const std::string& path) noexcept {
  RemoveIn(AT_FDCWD, path.c_str());
}

FileReplacement::~FileReplacement() {
  if (temporary_.empty()) return;
  const int reason = errno;
  unlink(temporary_.c_str());
  errno = reason;
}

Status FileReplacement::Commit() {
  if (rename(temporary_.c_str(), path_.c_str()) != 0)
    return SystemError("cannot write", named_, ErrorCode::kOutputFailed);
  temporary_.clear();
  const FileDescriptor folder(open(fs::path(path_).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() >= 0) fsync(folder.get());  // the name, too; a file system that cannot do it keeps the content
  return {};
}

Status WriteWholeFile(const std::string& path, std::string_view content) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
    Result<FileDescriptor> file = OpenToWrite(path);
    if (!file.ok()) return Error{{path}, "cannot write: " + file.error().message, file.error().code};
    return WriteAll(file.value().get(), content) && file.value().Close()
               ? Status()
               : SystemError("cannot write", path, ErrorCode::kOutputFailed);
  }
  Result<FileReplacement> replacement = FileReplacement::Prepare(path, content);
  return replacement.ok() ? replacement.value().Commit() : replacement.error();
}

Result<TemporaryFile> TemporaryFile::Create() {
  std::error_code no_folder;
  std::string path = (std::filesystem::temp_directory_path(no_folder) / "troupe-XXXXXX").string();
  FileDescriptor file(mkostemp(path.data(), O_CLOEXEC));
  if (file.get() < 0) {
    return SystemError("cannot create a temporary file", path);
  }
  unlink(path.c_str());
  return TemporaryFile(std::move(file));
}

}  // namespace troupe
