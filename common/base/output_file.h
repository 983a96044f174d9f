// OutputFile: text to a file, through a buffer. The first error stays, and no text is written after it.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "troupe/result.h"

namespace troupe {

class OutputFile {
 public:
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
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  OutputFile(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {}
  Status WriteBuffer();
  Error SystemError(const char* failed) const;

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::string buffer_;
  Status error_;
};

}  // namespace troupe
