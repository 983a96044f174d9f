#include "launcher/line_pipe.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "common/base/check.h"

namespace troupe {

LinePipe::LinePipe() {
  int ends[2];
  TROUPE_CHECK(pipe2(ends, O_CLOEXEC) == 0);
  reading_end_ = ends[0];
  writing_end_ = ends[1];
  fcntl(reading_end_, F_SETFL, O_NONBLOCK);  // children get the other end, which waits
}

LinePipe::~LinePipe() {
  CloseWritingEnd();
  close(reading_end_);
}

void LinePipe::CloseWritingEnd() {
  if (writing_end_ >= 0) close(std::exchange(writing_end_, -1));
}

std::vector<std::string> LinePipe::Read() {
  char buffer[65536];
  while (!at_end_) {
    ssize_t size = read(reading_end_, buffer, sizeof buffer);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) break;
    at_end_ = size == 0;
    partial_.append(buffer, static_cast<std::size_t>(size));
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

}  // namespace troupe
