#include "common/trace/phase_times.h"

namespace troupe {
namespace {

// ns. The mean is over the window before and the one in progress.
constexpr std::int64_t kWindow = 500'000'000;
constexpr std::int64_t kOldest = 5'000'000'000;  // older windows say nothing about the present

}  // namespace

void PhaseTimes::Enter(TickPhase phase, std::int64_t now) {
  if (phase_) now_.times[static_cast<std::size_t>(*phase_)] += now - entered_;
  // A window ends between two ticks, and slow ticks make long ones.
  if (phase == TickPhase::kWait && now_.ticks > 0 && now - now_.begin >= kWindow) {
    before_ = now_;
    now_ = {};
    now_.begin = now;
  }
  if (!phase_) now_.begin = now;
  if (phase == TickPhase::kStep) ++now_.ticks;
  phase_ = phase;
  entered_ = now;
}

void PhaseTimes::Restart(std::int64_t now) {
  entered_ = now;
}

double PhaseTimes::Mean(TickPhase phase, std::int64_t now) const {
  if (!phase_ || now - entered_ > kOldest) return 0.0;
  const std::uint64_t ticks = before_.ticks + now_.ticks;
  if (ticks == 0) return 0.0;
  const auto index = static_cast<std::size_t>(phase);
  return static_cast<double>(before_.times[index] + now_.times[index]) * 1e-9 / static_cast<double>(ticks);
}

}  // namespace troupe
