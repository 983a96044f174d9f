#include "world-service/service/rewind.h"

#include <chrono>
#include <utility>

#include "common/base/or_failure.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kWorkTime(20);  // so that the run sees a stop soon

}  // namespace

void Rewind::Start(const control::Rewind& request, const FrameMessage& newest) {
  stage_ = Stage::kMaking;
  request_ = request;
  newest_ = newest;
}

void Rewind::Work(RunHistory& history) {
  if (stage_ == Stage::kMaking) {
    has_more_ = OrFailure([&] { return MakeSome(history); });
  } else {
    written_ = OrFailure([&] { return states_->Write(); });
  }
}

Result<bool> Rewind::MakeSome(RunHistory& history) {
  if (states_ == nullptr) {
    Result<std::unique_ptr<RewindStates>> started = history.StartRewind(request_, newest_);
    if (!started.ok()) return started.error();
    states_ = std::move(started).value();
  }
  // The clock bounds only how much is made in one call; the states do not depend on it.
  const Clock::time_point end = Clock::now() + kWorkTime;
  for (;;) {
    Result<bool> more = states_->MakeSome();
    if (!more.ok() || !more.value() || Clock::now() >= end) return more;
  }
}

std::optional<Result<RewoundRun>> Rewind::Advance(bool run_ends) {
  std::optional<Result<RewoundRun>> outcome = std::exchange(written_, std::nullopt);
  if (!has_more_.ok()) outcome = has_more_.error();
  if (!outcome && run_ends) outcome = Failure("the run is over");
  if (outcome) {
    // Whatever the outcome, the rewind is over and holds no states of the recording any more.
    *this = Rewind();
  } else if (!has_more_.value()) {
    stage_ = Stage::kWriting;
  }
  return outcome;
}

}  // namespace troupe
