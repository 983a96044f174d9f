// FileReplacement: the new content of a file, written beside it, that then takes its place as a whole: on a full disk,
// or after a loss of power, the file is as before. For all files that are written at once.
#pragma once

#include <string>
#include <string_view>

#include "troupe/result.h"

namespace troupe {

class FileReplacement {
 public:
  // Writes the content to the disk, with the permissions and the owner of the file at `path` if there is one. A
  // symbolic link stays one, and its target is replaced; another hard link keeps the old content. Anything but a
  // regular file is refused. The error names the file.
  static Result<FileReplacement> Prepare(const std::string& path, std::string_view content);
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

// Prepares and commits. Unlike there, a device, or an open pipe (/dev/stdout), is written to as it is.
Status WriteWholeFile(const std::string& path, std::string_view content);

}  // namespace troupe
