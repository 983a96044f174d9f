#include "viewer/editor/file_replacement.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace troupe {
namespace {

namespace fs = std::filesystem;

Error CannotWrite(const std::string& path, const char* what) {
  return {{path},
          fmt::format("cannot {}: {}; the file is as it was", what, std::strerror(errno)),
          ErrorCode::kOutputFailed};
}

bool WriteAll(int descriptor, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = write(descriptor, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    written += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

Result<FileReplacement> FileReplacement::Prepare(const std::string& named, const std::string& content) {
  std::error_code error;
  const fs::path path = fs::exists(named, error) ? fs::canonical(named, error) : fs::path(named);
  if (error) return Error{{named}, "cannot find the file: " + error.message(), ErrorCode::kOutputFailed};
  mode_t mode = 0644;
  if (struct stat status{}; stat(path.c_str(), &status) == 0) {
    if (access(path.c_str(), W_OK) != 0) return CannotWrite(named, "write the file");
    mode = status.st_mode & 07777;
  }
  const fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  std::string temporary = (folder / ("." + path.filename().string() + ".XXXXXX")).string();
  const int descriptor = mkostemp(temporary.data(), O_CLOEXEC);
  if (descriptor < 0) return CannotWrite(named, "create a file beside it");
  FileReplacement replacement;
  replacement.named_ = named;
  replacement.path_ = path.string();
  replacement.temporary_ = std::move(temporary);
  bool done = WriteAll(descriptor, content) && fchmod(descriptor, mode) == 0 && fsync(descriptor) == 0;
  const int reason = errno;
  done = close(descriptor) == 0 && done;
  if (done) return replacement;
  errno = reason;
  return CannotWrite(named, "save");
}

FileReplacement::FileReplacement(FileReplacement&& other) noexcept
    : named_(std::move(other.named_)),
      path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, std::string())) {}

FileReplacement::~FileReplacement() {
  if (temporary_.empty()) return;
  const int reason = errno;
  unlink(temporary_.c_str());
  errno = reason;
}

Status FileReplacement::Commit() {
  if (rename(temporary_.c_str(), path_.c_str()) != 0) return CannotWrite(named_, "save");
  temporary_.clear();
  const fs::path folder = fs::path(path_).parent_path();
  const int directory = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory >= 0) {
    fsync(directory);  // the name, too; a file system that cannot do it keeps the content
    close(directory);
  }
  return {};
}

}  // namespace troupe
