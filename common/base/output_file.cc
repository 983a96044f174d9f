#include "common/base/output_file.h"

#include <cerrno>
#include <charconv>
#include <cstring>

namespace troupe {
namespace {

constexpr std::size_t kWriteSize = std::size_t{64} * 1024;  // bytes

}  // namespace

Result<OutputFile> OutputFile::Create(const std::string& path) {
  std::FILE* const file = std::fopen(path.c_str(), "we");
  if (file == nullptr) {
    return Error{{path}, std::string("cannot open for writing: ") + std::strerror(errno), ErrorCode::kFailure};
  }
  std::setvbuf(file, nullptr, _IONBF, 0);  // the buffer here is enough
  return OutputFile(path, file);
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
  if (error_.ok() && std::fwrite(buffer_.data(), 1, buffer_.size(), file_.get()) != buffer_.size()) {
    error_ = SystemError("cannot write: ");
  }
  buffer_.clear();
  return error_;
}

Status OutputFile::Close() {
  if (file_ == nullptr) return error_;
  (void)WriteBuffer();  // error_ keeps its outcome
  if (std::fclose(file_.release()) != 0 && error_.ok()) error_ = SystemError("cannot close: ");
  return error_;
}

Error OutputFile::SystemError(const char* failed) const {
  return {{path_}, std::string(failed) + std::strerror(errno), ErrorCode::kFailure};
}

}  // namespace troupe
