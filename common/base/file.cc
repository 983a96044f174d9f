#include "common/base/file.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

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

}  // namespace troupe
