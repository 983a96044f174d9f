// Files by their descriptors: opened only where no program is waited for, and read and written to the end.
//
// The message of an error is the reason alone ("No such file or directory", "it is a named pipe, ..."), behind which
// callers say what they could not do; its place is the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "troupe/result.h"

namespace troupe {

// An open file, which is closed at the end.
class FileDescriptor {
 public:
  explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
  FileDescriptor(FileDescriptor&& other) noexcept : descriptor_(other.Release()) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  ~FileDescriptor() { (void)Close(); }

  int get() const { return descriptor_; }
  // The caller closes it.
  int Release();
  // False, with the reason in errno: not all that was written is in the file.
  bool Close();

 private:
  int descriptor_;  // -1: none
};

// The error of the last system call, from errno.
Error FileError(const std::string& path, ErrorCode code = ErrorCode::kFailure);

// Opens a regular file; a folder, a pipe or a device could wait for a program, fail late or never end. Any other error
// has the code kFailure.
Result<FileDescriptor> OpenToRead(const std::string& path);

// Opens a regular file, which is made if there is none, or a device or an open pipe of a process (/dev/null,
// /dev/stdout). Named pipes are refused as above: without a reader, a program would wait for one. `flags`: more of
// open(2), as O_TRUNC.
Result<FileDescriptor> OpenToWrite(const std::string& path, int flags = 0);

// Whether OpenToWrite can open the file. Changes nothing, and leaves none that was not there.
Status CheckWritable(const std::string& path);

// The content from here to the end, whatever size the file system states: a file in /proc has size 0 there. A file of
// more than `most` bytes is refused with the code kBadInput.
Result<std::string> ReadToEnd(const FileDescriptor& file, const std::string& path, std::size_t most);

// OpenToRead and ReadToEnd.
Result<std::string> ReadWholeFile(const std::string& path, std::size_t most);

// Waits where the descriptor itself does not. False, with the reason in errno: not all is written.
bool WriteAll(int descriptor, std::string_view bytes);

// Removes what is at the path, a folder with all that is in it, as far as the system allows. It needs no memory, so
// that destructors can call it.
void RemoveAll(const std::string& path) noexcept;

// FileReplacement: the new content of a file, written beside it, that then takes its place as a whole: on a full disk,
// or after a loss of power, the file is as before. For all files that are written at once.
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

// Prepares and commits. A device or an open pipe (/dev/stdout) is written to directly.
Status WriteWholeFile(const std::string& path, std::string_view content);

// TemporaryFile: a file without a name, in the folder for temporary files (TMPDIR). It ends with the process, however
// that ends.
class TemporaryFile {
 public:
  static Result<TemporaryFile> Create();

  // The path by which this process can open the file while the object exists.
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_.get()); }

 private:
  explicit TemporaryFile(FileDescriptor file) : file_(std::move(file)) {}

  FileDescriptor file_;
};

}  // namespace troupe
