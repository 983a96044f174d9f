#include "launcher/supervise/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

#include "common/base/utf8.h"
#include "transport/protocol/waiting_text.h"
#include "troupe/event.h"

namespace troupe {
namespace {

constexpr auto kTimeBetweenLines = std::chrono::seconds(5);

// A longer line would wrap, and the next one would not cover it.
std::size_t TerminalWidth() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string StatusText(const StatusMessage& status) {
  std::string text = fmt::format("tick {}", status.tick);
  if (status.target_ticks > 0) text += fmt::format("/{}", status.target_ticks);
  text += fmt::format(", {:.1f} s, {:.1f} x real time, {} robots", status.sim_seconds, status.real_time_factor,
                      status.robots);
  if (!status.waiting_for.empty()) text += ", waiting for " + WaitingText(status);
  return text;
}

Progress::Progress()
    : terminal_(isatty(STDERR_FILENO) == 1), next_line_(std::chrono::steady_clock::now() + kTimeBetweenLines) {}

Progress::~Progress() {
  ClearStatusLine();
}

void Progress::Update(const StatusMessage& status) {
  if (terminal_) {
    ClearStatusLine();
    status_line_ = PlainLine(StatusText(status), TerminalWidth() - 1);
    fmt::print(stderr, "{}", status_line_);
    std::fflush(stderr);
  } else if (std::chrono::steady_clock::now() >= next_line_) {
    Tell(StatusText(status));
    next_line_ = std::chrono::steady_clock::now() + kTimeBetweenLines;
  }
}

void Progress::TellEvent(Tick tick, const std::string& event, const std::string& text) {
  const bool stall = event == ToString(EventType::kStallBegan) || event == ToString(EventType::kStallEnded);
  // Agents that join at tick 0 begin the run, unless one has been lost since.
  const bool start = tick == 0 && event == ToString(EventType::kJoined) && !has_lost_agent_;
  has_lost_agent_ = has_lost_agent_ || event == ToString(EventType::kLeft);
  if (!stall && !start) Tell(text);
}

void Progress::Tell(const std::string& line) {
  std::string kept = status_line_;
  ClearStatusLine();
  fmt::print(stderr, "{}\n{}", PlainLine(line), kept);
  std::fflush(stderr);
  status_line_ = kept;
}

void Progress::ClearStatusLine() {
  if (status_line_.empty()) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  status_line_.clear();
}

}  // namespace troupe
