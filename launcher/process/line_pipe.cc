#include "launcher/process/line_pipe.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace troupe {

LineReader::LineReader(int descriptor) : descriptor_(descriptor) {
  fcntl(descriptor_, F_SETFL, fcntl(descriptor_, F_GETFL) | O_NONBLOCK);
}

std::vector<std::string> LineReader::Read() {
  while (!at_end_) {
    constexpr std::size_t kPiece = 65536;  // bytes; too many for a small stack (ulimit -s)
    const std::size_t before = partial_.size();
    partial_.resize(before + kPiece);
    const ssize_t size = read(descriptor_, partial_.data() + before, kPiece);
    const int reason = errno;
    partial_.resize(before + static_cast<std::size_t>(size > 0 ? size : 0));
    if (size < 0 && reason == EINTR) continue;
    if (size < 0 && reason == EAGAIN) break;
    at_end_ = size <= 0;  // what cannot be read has no more lines
  }
  if (at_end_ && !partial_.empty() && partial_.back() != '\n') partial_ += '\n';
  std::vector<std::string> lines;
  std::size_t begin = 0;
  for (std::size_t end; (end = partial_.find('\n', begin)) != std::string::npos; begin = end + 1) {
    lines.push_back(partial_.substr(begin, end - begin));
  }
  partial_.erase(0, begin);
  return lines;
}

LinePipe::Ends::Ends() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "making a pipe");
  reading = ends[0];
  writing = ends[1];
}

// Only the reading end is non-blocking; children inherit the writing end.
LinePipe::LinePipe() : reader_(ends_.reading) {}

LinePipe::~LinePipe() {
  CloseWritingEnd();
  close(ends_.reading);
}

void LinePipe::CloseWritingEnd() {
  if (ends_.writing >= 0) close(std::exchange(ends_.writing, -1));
}

}  // namespace troupe
