#include "common/base/file_replacement.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/random_id.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

Error CannotWrite(const std::string& path) {
  return {{path}, std::string("cannot write: ") + std::strerror(errno), ErrorCode::kOutputFailed};
}

constexpr std::size_t kLongestFileName = 255;  // bytes

// A name that no program looks for.
fs::path NameBeside(const fs::path& path) {
  const std::string ending = "." + std::to_string(MakeRandomId());
  const std::string name = "." + path.filename().string();
  return path.parent_path() / (name.substr(0, kLongestFileName - ending.size()) + ending);
}

// The path of the file that is written, which is no link; its file may be missing.
Result<fs::path> TargetOf(const std::string& named) {
  constexpr int kMostLinks = 40;  // as in Linux
  std::error_code error;
  fs::path path = fs::absolute(named, error);
  for (int links = 0; !error && fs::is_symlink(path, error); ++links) {
    if (links == kMostLinks) error = std::make_error_code(std::errc::too_many_symbolic_link_levels);
    if (!error) path = path.parent_path() / fs::read_symlink(path, error);
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    return Error{{named}, "cannot write: " + error.message(), ErrorCode::kOutputFailed};
  }
  return path;
}

}  // namespace

Result<FileReplacement> FileReplacement::Prepare(const std::string& named, std::string_view content) {
  const Result<fs::path> path = TargetOf(named);
  if (!path.ok()) return path.error();
  struct stat old = {};
  const bool exists = stat(path.value().c_str(), &old) == 0;
  if (exists && !S_ISREG(old.st_mode)) return Error{{named}, "cannot write: it is not a file, expected a regular file"};
  if (exists && access(path.value().c_str(), W_OK) != 0) return CannotWrite(named);
  const fs::path temporary = NameBeside(path.value());
  FileDescriptor file(open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.get() < 0) return CannotWrite(named);
  FileReplacement replacement;
  replacement.named_ = named;
  replacement.path_ = path.value().string();
  replacement.temporary_ = temporary.string();
  // The owner first: a change of it may clear permissions. Only root can give a file away.
  if (exists && (old.st_uid != geteuid() || old.st_gid != getegid())) {
    static_cast<void>(fchown(file.get(), old.st_uid, old.st_gid) == 0);
  }
  const bool written = WriteAll(file.get(), content) && (!exists || fchmod(file.get(), old.st_mode & 07777) == 0) &&
                       fsync(file.get()) == 0;
  if (written && file.Close()) return replacement;
  return CannotWrite(named);
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
  if (rename(temporary_.c_str(), path_.c_str()) != 0) return CannotWrite(named_);
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
    return WriteAll(file.value().get(), content) && file.value().Close() ? Status() : CannotWrite(path);
  }
  Result<FileReplacement> replacement = FileReplacement::Prepare(path, content);
  return replacement.ok() ? replacement.value().Commit() : replacement.error();
}

}  // namespace troupe
