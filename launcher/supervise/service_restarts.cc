#include "launcher/supervise/service_restarts.h"

#include <cmath>

namespace troupe {
namespace {

constexpr std::uint32_t kMostWithoutProgress = 8;
constexpr double kSecondDelay = 0.1;  // s, before the second restart at one tick

}  // namespace

std::optional<double> ServiceRestarts::OnDeath(Tick tick, double now) {
  without_progress_ = tick_ == tick ? without_progress_ + 1 : 0;
  tick_ = tick;
  if (without_progress_ >= kMostWithoutProgress) return std::nullopt;
  const double delay = without_progress_ == 0 ? 0.0 : std::ldexp(kSecondDelay, static_cast<int>(without_progress_) - 1);
  due_ = now + delay;
  return due_;
}

}  // namespace troupe
