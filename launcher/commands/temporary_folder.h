// TemporaryFolder: a folder for temporary files, which is removed at the end.
//
// Readable by this user only (mkdtemp). A process that is killed leaves it behind; files that must never be left have
// no name (OutputParts).
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>
#include <utility>

#include "common/base/file.h"

namespace troupe {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code ignored;
    std::string pattern = (std::filesystem::temp_directory_path(ignored) / "troupe-XXXXXX").string();
    if (mkdtemp(pattern.data()) != nullptr) path_ = std::move(pattern);
  }
  ~TemporaryFolder() {
    if (!path_.empty()) RemoveAll(path_);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }  // empty: it could not be made

 private:
  std::string path_;
};

}  // namespace troupe
