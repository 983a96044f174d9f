#include "common/base/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>

#include "common/base/system_error.h"

namespace troupe {
namespace {

constexpr std::size_t kWriteSize = std::size_t{64} * 1024;  // bytes

constexpr std::size_t kPiece = std::size_t{64} * 1024;  // bytes: hundreds of files are open at the same time
constexpr std::int64_t kBlock = 4096;                   // bytes: space is free in whole blocks

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
    error_ = SystemError("cannot write", path_);
  }
  buffer_.clear();
  return error_;
}

Status OutputFile::Close() {
  (void)WriteBuffer();  // error_ keeps its outcome
  if (!file_.Close() && error_.ok()) {
    error_ = SystemError("cannot close", path_);
  }
  return error_;
}

Result<LineFile> LineFile::Open(const std::string& path, Space space) {
  FileDescriptor file(open(path.c_str(), (space == Space::kFree ? O_RDWR : O_RDONLY) | O_CLOEXEC));
  if (file.get() < 0) return SystemError("cannot read", path);
  return LineFile(path, std::move(file), space);
}

bool LineFile::ReadMore() {
  text_.erase(0, begin_);
  begin_ = 0;
  const std::size_t before = text_.size();
  text_.resize(before + kPiece);
  ssize_t size = 0;
  do {
    size = read(file_.get(), text_.data() + before, kPiece);
  } while (size < 0 && errno == EINTR);
  if (size < 0) status_ = SystemError("cannot read", path_);
  text_.resize(before + static_cast<std::size_t>(size > 0 ? size : 0));
  if (size <= 0) return false;
  read_ += size;
  if (space_ == Space::kFree) {
    // Where the file system cannot do this, the copy needs space of its own.
    const int done = fallocate(file_.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, freed_, read_ - freed_);
    // A block that is read in part is freed with the next piece.
    if (done == 0) freed_ = read_ / kBlock * kBlock;
  }
  return true;
}

bool LineFile::Next(std::string& line) {
  std::size_t searched = begin_;
  for (;;) {
    const std::size_t end = text_.find('\n', searched);
    if (end != std::string::npos) {
      line.assign(text_, begin_, end - begin_);
      begin_ = end + 1;
      return true;
    }
    searched = text_.size() - begin_;
    if (!ReadMore()) return false;
  }
}

}  // namespace troupe
