// FileReplacement: the new content of a file, written beside it, that then takes its place as a whole.
#pragma once

#include <string>

#include "troupe/result.h"

namespace troupe {

class FileReplacement {
 public:
  // Writes the content to the disk, with the permissions of the file at `path` if there is one. A link stays a link.
  static Result<FileReplacement> Prepare(const std::string& path, const std::string& content);
  ~FileReplacement();
  FileReplacement(FileReplacement&& other) noexcept;
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;
  FileReplacement& operator=(FileReplacement&&) = delete;

  // On an error the file is as before. Without a call nothing is left of the content.
  Status Commit();

 private:
  FileReplacement() = default;

  std::string named_;      // as the caller names it
  std::string path_;       // without links
  std::string temporary_;  // empty: none is left
};

}  // namespace troupe
