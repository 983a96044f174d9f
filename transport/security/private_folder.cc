#include "transport/security/private_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "common/base/file.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

Error SystemFailure(const fs::path& path, const std::string& failed) {
  return {{path.string()}, failed + ": " + std::strerror(errno), ErrorCode::kFailure};
}

// Most often the user has named a place where no folder can be.
Error FolderFailure(const fs::path& path) {
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EIO;
  Error error = SystemFailure(path, "cannot make the folder");
  if (!full) error.code = ErrorCode::kBadInput;
  return error;
}

Status MakeFolders(const fs::path& folder) {
  if (folder.empty() || fs::is_directory(folder)) return {};
  if (Status above = MakeFolders(folder.parent_path()); !above.ok()) return above;
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return FolderFailure(folder);
  return {};
}

Status WriteFile(const fs::path& path, const std::string& content) {
  FileDescriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (file.get() < 0) return SystemFailure(path, "cannot make the file");
  const bool written = WriteAll(file.get(), content);
  return written && file.Close() ? Status() : SystemFailure(path, "cannot write the file");
}

// A folder is never replaced by a rename, unless it is empty.
Status Publish(const fs::path& temporary, const fs::path& folder) {
  if (std::rename(temporary.c_str(), folder.c_str()) == 0) return {};
  if (errno == ENOTEMPTY || errno == EEXIST || errno == ENOTDIR) {
    return Error{{folder.string()}, "exists already, and is not overwritten"};
  }
  return FolderFailure(folder);
}

}  // namespace

Status WritePrivateFolder(const std::string& folder, const std::vector<PrivateFile>& files) {
  fs::path path(folder);
  if (!path.has_filename()) path = path.parent_path();  // written with a slash at its end
  if (Status above = MakeFolders(path.parent_path()); !above.ok()) return above;
  std::string temporary = path.string() + ".new-XXXXXX";
  if (mkdtemp(temporary.data()) == nullptr) return FolderFailure(path);
  Status status;
  for (const PrivateFile& file : files) {
    status = WriteFile(fs::path(temporary) / file.name, file.content);
    if (!status.ok()) break;
  }
  if (status.ok()) status = Publish(temporary, path);
  if (status.ok()) return status;
  std::error_code ignored;
  fs::remove_all(temporary, ignored);
  return status;
}

Result<std::string> ReadFileOfKeys(const std::string& path) {
  constexpr std::size_t kMost = 1'000'000;  // bytes
  Result<std::string> content = ReadWholeFile(path, kMost);
  if (content.ok()) return content;
  return Error{{path}, "cannot read: " + content.error().message};
}

}  // namespace troupe
