#include "common/base/flood_limiter.h"

#include <utility>

#include "common/base/utf8.h"

namespace troupe {

FloodLimiter::FloodLimiter(Tell tell) : tell_(std::move(tell)), second_began_(std::chrono::steady_clock::now()) {}

FloodLimiter::~FloodLimiter() {
  TellSum();
}

void FloodLimiter::Add(const std::string& line) {
  if (!tell_) return;
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - second_began_ >= std::chrono::seconds(1)) {
    TellSum();
    second_began_ = now;
    told_ = 0;
  }
  if (told_ == kLinesInASecond) {
    ++left_out_;
    return;
  }
  ++told_;
  tell_(PlainLine(line));
}

void FloodLimiter::TellSum() {
  if (left_out_ > 0) tell_(std::to_string(std::exchange(left_out_, 0)) + " more lines like these");
}

}  // namespace troupe
