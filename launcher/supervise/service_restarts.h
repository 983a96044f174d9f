// ServiceRestarts: decides whether and when a world service that died is started again. Without a clock and processes
// of its own: times are in s, of any clock that does not decrease.
#pragma once

#include <cstdint>
#include <optional>

#include "troupe/ids.h"

namespace troupe {

class ServiceRestarts {
 public:
  // A service died after it had reported this tick: the time of its restart, at once for the first that makes no
  // progress, and later for each that follows. Nothing when it makes none time and again: another would die likewise.
  std::optional<double> OnDeath(Tick tick, double now);

  const std::optional<double>& due() const { return due_; }
  // The service is started: the restart is made.
  void OnStart() {
    due_.reset();
    ++count_;
  }
  void Cancel() { due_.reset(); }
  std::uint32_t count() const { return count_; }  // restarts that were made

 private:
  std::optional<Tick> tick_;            // of the last death
  std::uint32_t without_progress_ = 0;  // deaths at this tick
  std::optional<double> due_;
  std::uint32_t count_ = 0;
};

}  // namespace troupe
