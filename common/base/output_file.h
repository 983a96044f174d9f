// Texts of many lines as files: written through a buffer, and read line by line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/file.h"
#include "troupe/result.h"

namespace troupe {

// OutputFile: text to a file, through a buffer. The first error stays, and no text is written after it; what was
// written before it is kept.
class OutputFile {
 public:
  // Empties the file, or makes it.
  static Result<OutputFile> Create(const std::string& path);

  void Append(std::string_view text) { buffer_ += text; }
  void Append(std::uint64_t number);
  // The shortest text that reads back as the same number.
  void Append(double number);
  // 16 digits.
  void AppendHex(std::uint64_t number);

  // Ends a line, and writes when the buffer is full. The error is that of the file so far (a full disk).
  Status EndLine();
  // Writes all buffered text.
  Status Flush() { return WriteBuffer(); }
  Status Close();

 private:
  OutputFile(std::string path, FileDescriptor file) : path_(std::move(path)), file_(std::move(file)) {}
  Status WriteBuffer();

  std::string path_;
  FileDescriptor file_;
  std::string buffer_;
  Status error_;
};

// LineFile: the lines of a temporary file.
class LineFile {
 public:
  // kFree: the space of the file is given back to its file system while it is read, so that a copy of its lines fits
  // even on a full disk. The file then has only zeros.
  enum class Space : bool { kKeep, kFree };

  static Result<LineFile> Open(const std::string& path, Space space);
  // The next line, without its end. False at the end of the file, and where it cannot be read; a last line without an
  // end, as a killed process leaves it, is omitted.
  bool Next(std::string& line);
  // After the last line: an error if the file has more, which cannot be read.
  const Status& status() const { return status_; }

 private:
  LineFile(std::string path, FileDescriptor file, Space space)
      : path_(std::move(path)), file_(std::move(file)), space_(space) {}
  // Reads a piece behind the text that is not yet consumed. False at the end.
  bool ReadMore();

  std::string path_;
  FileDescriptor file_;
  Space space_;
  Status status_;
  std::string text_;  // read, from `begin_` on not yet consumed
  std::size_t begin_ = 0;
  std::int64_t read_ = 0;   // bytes of the file
  std::int64_t freed_ = 0;  // bytes of the file whose space is free
};

}  // namespace troupe
