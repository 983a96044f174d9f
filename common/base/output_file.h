// OutputFile: text to a file, through a buffer. The first error stays, and no text is written after it; what was
// written before it is kept.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/file.h"
#include "troupe/result.h"

namespace troupe {

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
  Status Close();

 private:
  OutputFile(std::string path, FileDescriptor file) : path_(std::move(path)), file_(std::move(file)) {}
  Status WriteBuffer();

  std::string path_;
  FileDescriptor file_;
  std::string buffer_;
  Status error_;
};

}  // namespace troupe
