#include "common/base/line_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kPiece = std::size_t{64} * 1024;  // bytes: hundreds of files are open at the same time
constexpr std::int64_t kBlock = 4096;                   // bytes: space is free in whole blocks

}  // namespace

Result<LineFile> LineFile::Open(const std::string& path, Space space) {
  FileDescriptor file(open(path.c_str(), (space == Space::kFree ? O_RDWR : O_RDONLY) | O_CLOEXEC));
  if (file.get() < 0) return Error{{path}, std::string("cannot read: ") + std::strerror(errno), ErrorCode::kFailure};
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
  if (size < 0) status_ = Error{{path_}, std::string("cannot read: ") + std::strerror(errno), ErrorCode::kFailure};
  text_.resize(before + static_cast<std::size_t>(size > 0 ? size : 0));
  if (size <= 0) return false;
  read_ += size;
  if (space_ == Space::kFree) {
    // Where the file system cannot do this, the copy needs space of its own.
    const int done = fallocate(file_.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, freed_, read_ - freed_);
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
