#include "common/base/output_file.h"

#include <fcntl.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kWriteSize = std::size_t{64} * 1024;  // bytes

}  // namespace

Result<OutputFile> OutputFile::Create(const std::string& path) {
  Result<FileDescriptor> file = OpenToWrite(path, O_TRUNC);
  if (!file.ok()) return Error{{path}, "cannot open for writing: " + file.error().message, file.error().code};
  return OutputFile(path, std::move(file).value());
}

void OutputFile::Append(std::uint64_t number) {
  char digits[24];
  buffer_.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
}

void OutputFile::Append(double number) {
  char digits[32];
  buffer_.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
}

void OutputFile::AppendHex(std::uint64_t number) {
  for (int shift = 60; shift >= 0; shift -= 4) buffer_ += "0123456789abcdef"[(number >> shift) & 15];
}

Status OutputFile::EndLine() {
  buffer_ += '\n';
  if (buffer_.size() >= kWriteSize) return WriteBuffer();
  return error_;
}

Status OutputFile::WriteBuffer() {
  if (error_.ok() && !WriteAll(file_.get(), buffer_)) {
    error_ = Error{{path_}, std::string("cannot write: ") + std::strerror(errno), ErrorCode::kFailure};
  }
  buffer_.clear();
  return error_;
}

Status OutputFile::Close() {
  (void)WriteBuffer();  // error_ keeps its outcome
  if (!file_.Close() && error_.ok()) {
    error_ = Error{{path_}, std::string("cannot close: ") + std::strerror(errno), ErrorCode::kFailure};
  }
  return error_;
}

}  // namespace troupe
