// An observer of a run: follows its frames and checks the hash of each.
//   soak_observer DOMAIN SESSION SECONDS [REPORT_SECONDS]
// Ends after SECONDS of wall time, at SIGTERM, or with the service; with status 3 if a hash is wrong, or if no frame
// arrived within 10 s. With REPORT_SECONDS it prints a line for each such period: the number of frames, and the mean
// and the largest wall time in ms from one frame to the frame of the next tick; the mean without waits for lost agents.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "command_line/parse_command_line.h"
#include "common/base/wake_event.h"
#include "common/model/states.h"
#include "transport/dds/transport/dds_transport.h"
#include "transport/security/session_keys.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMaxSilence = 10.0;  // s, before the first frame
constexpr double kMaxTick = 500.0;    // ms: a longer time is a wait for the lease of an agent

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class Observer final : public ObserverHandler {
 public:
  void OnSession(const SessionMessage&) override {}
  void OnStatus(const StatusMessage&) override {}
  void OnServiceGone() override { over_ = true; }
  void OnFrame(const SharedFrame& frame) override {
    const auto now = Clock::now();
    const std::lock_guard lock(mutex_);
    if (StateHash(frame->state) != frame->state_hash) wrong_ = true;
    ++frames_;
    // A pause, an edit and a lost frame are no ticks.
    if (!was_paused_ && !frame->paused && frame->state.tick == last_tick_ + 1) {
      tick_ms_.push_back(1e3 * std::chrono::duration<double>(now - last_at_).count());
    }
    was_paused_ = frame->paused;
    last_tick_ = frame->state.tick;
    last_at_ = now;
    seen_ = true;
  }

  bool over() const { return over_; }
  bool wrong() const { return wrong_; }
  bool seen() const { return seen_; }

  // The line of a period, which ends.
  std::string Report() {
    const std::lock_guard lock(mutex_);
    double sum = 0.0;
    double longest = 0.0;
    int count = 0;
    for (const double ms : tick_ms_) {
      longest = std::max(longest, ms);
      if (ms > kMaxTick) continue;
      sum += ms;
      ++count;
    }
    std::string line = fmt::format("{} {:.3f} {:.3f}\n", frames_, count > 0 ? sum / count : 0.0, longest);
    frames_ = 0;
    tick_ms_.clear();
    return line;
  }

 private:
  std::atomic<bool> over_ = false;
  std::atomic<bool> wrong_ = false;
  std::atomic<bool> seen_ = false;
  std::mutex mutex_;  // guards everything below
  std::size_t frames_ = 0;
  std::vector<double> tick_ms_;
  Tick last_tick_ = 0;
  Clock::time_point last_at_;
  bool was_paused_ = true;
};

int Observe(const DdsOptions& options, double seconds, double report_seconds) {
  const StopSignals signals;
  const std::unique_ptr<Transport> transport = MakeDdsObserverTransport(options);
  Observer observer;
  const std::unique_ptr<ObserverEndpoint> endpoint = transport->MakeObserverEndpoint();
  endpoint->Start(observer);
  const auto start = Clock::now();
  auto reported = start;
  while (!signals.requested() && !observer.over() && Since(start) < seconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (!observer.seen() && Since(start) > kMaxSilence) {
      fmt::print(stderr, "error: no frame within {} s\n", kMaxSilence);
      return kExitFailed;
    }
    if (report_seconds > 0.0 && Since(reported) >= report_seconds) {
      reported = Clock::now();
      fmt::print("{}", observer.Report());
      std::fflush(stdout);
    }
  }
  if (!observer.wrong()) return kExitDone;
  fmt::print(stderr, "error: a frame with a wrong hash\n");
  return kExitFailed;
}

}  // namespace
}  // namespace troupe

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  if (argc != 4 && argc != 5) {
    fmt::print(stderr, "error: expected DOMAIN SESSION SECONDS [REPORT_SECONDS]\n");
    return troupe::kExitBadInput;
  }
  troupe::DdsOptions options;
  options.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  options.session = argv[2];
  try {
    troupe::Result<troupe::ParticipantKeys> keys =
        troupe::FindKeys(options.security, options.domain, options.session, troupe::Role::Observer());
    if (!keys.ok()) throw std::runtime_error(keys.error().ToString());
    options.keys = std::move(keys).value();
    return troupe::Observe(options, std::atof(argv[3]), argc == 5 ? std::atof(argv[4]) : 0.0);
  } catch (const std::exception& exception) {
    fmt::print(stderr, "error: {}\n", exception.what());
    return troupe::kExitFailed;
  }
}
