// The texts of `troupe top`: a table of all sessions, and the robots of one.
//
// Texts only: no terminal, no clock but that of the rates, so that tests read what a user sees. `troupe top` is an
// observer as any viewer is, and delays no tick.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "transport/dds/tools/session_monitor.h"
#include "transport/protocol/transport.h"

namespace troupe {

// A heading and a line for each session, columns aligned.
std::string SessionTable(const std::vector<SessionInfo>& sessions);

// The robots of one session, the lost, late and stalled ones first.
//
// Threads: the handler calls come on one thread, Text on another.
class SessionTop final : public ObserverHandler {
 public:
  // A few lines about the run, then the robots: at most `rows` lines in all. Ticks a second are those since the last
  // call.
  std::string Text(std::size_t rows);

  void OnSession(const SessionMessage& session) override;
  void OnFrame(const SharedFrame& frame) override;
  void OnStatus(const StatusMessage& status) override;
  void OnServiceGone() override;

 private:
  using Clock = std::chrono::steady_clock;

  // Forgets the run. REQUIRES: mutex_ is locked.
  void Reset();
  std::string RunText(double ticks_per_second, std::size_t lost) const;
  bool IsLate(const std::string& robot) const;

  std::mutex mutex_;                               // guards the others
  std::shared_ptr<const SessionMessage> session_;  // the newest; null: none
  std::shared_ptr<const SessionMessage> shown_;    // with the world of frame_
  SharedFrame frame_;                              // the newest; null: none
  std::optional<StatusMessage> status_;
  std::set<std::string> lost_;  // since the first frame that was received: robots by name, which outlives an edit
  Tick counted_tick_ = 0;
  Clock::time_point counted_at_ = Clock::now();
};

}  // namespace troupe
