#include "transport/security/private_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

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
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return SystemFailure(path, "cannot make the file");
  std::size_t written = 0;
  while (written < content.size()) {
    const ssize_t count = write(file, content.data() + written, content.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    written += static_cast<std::size_t>(count);
  }
  Status status;
  if (written < content.size()) status = SystemFailure(path, "cannot write the file");
  if (close(file) != 0 && status.ok()) status = SystemFailure(path, "cannot write the file");
  return status;
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

Result<std::string> ReadWholeFile(const std::string& path) {
  const std::ifstream file(path, std::ios::binary);
  if (!file) return Error{{path}, std::string("cannot read: ") + std::strerror(errno)};
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

}  // namespace troupe
