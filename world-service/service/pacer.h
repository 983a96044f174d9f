// Pacer: when a tick may be committed, so that simulated time keeps a fixed speed. Times in s, of any clock.
#pragma once

#include <limits>
#include <optional>

#include "troupe/ids.h"

namespace troupe {

class Pacer {
 public:
  // `speed`: multiple of real time; nothing: no pacing. `interval`: length of a tick in simulated s.
  Pacer(std::optional<double> speed, double interval) : speed_(speed) { SetInterval(interval); }

  void SetInterval(double interval) { period_ = speed_ ? interval / *speed_ : 0.0; }
  // The next tick is due after its period at the new speed.
  void SetSpeed(std::optional<double> speed, double interval, Tick tick, double now) {
    speed_ = speed;
    SetInterval(interval);
    Resume(tick, now);
  }
  const std::optional<double>& speed() const { return speed_; }
  void Start(double now) { start_ = now; }
  // Time continues after a pause, which is not caught up.
  void Resume(Tick tick, double now) { start_ = now - static_cast<double>(tick) * period_; }

  double Due(Tick tick) const {
    if (period_ == 0.0) return -std::numeric_limits<double>::infinity();
    return start_ + static_cast<double>(tick) * period_;
  }

  // Call when a tick was committed. A short delay is caught up; a long one shifts the later ticks.
  void Committed(Tick tick, double now) {
    const double late = now - Due(tick);
    if (period_ > 0.0 && late > kCatchUp) start_ += late;
  }

 private:
  static constexpr double kCatchUp = 0.5;  // s

  std::optional<double> speed_;
  double period_ = 0.0;  // wall time of a tick
  double start_ = 0.0;
};

}  // namespace troupe
