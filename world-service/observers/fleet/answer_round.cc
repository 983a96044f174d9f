#include "world-service/observers/fleet/answer_round.h"

#include <algorithm>
#include <utility>

namespace troupe {

void AnswerRound::Enter(Stage stage) {
  stage_ = stage;
  is_new_ = true;
}

void AnswerRound::Begin() {
  if (!wait_.waits() || has_ended_) return;
  has_told_late_ = false;
  Enter(Stage::kSending);
}

AnswerRound::Act AnswerRound::Next(double now) {
  if (stage_ == Stage::kNone) return Act::kNone;
  if (stage_ == Stage::kAnswering) {
    if (wait_.is_lockstep) {
      if (is_new_) latest_ = now + kLongAnswer;
      if (!std::exchange(is_new_, false) && now < due_) return Act::kNone;
      due_ = now + kAskAgain;
      return Act::kAsk;
    }
    if (std::exchange(is_new_, false)) {
      due_ = now + wait_.quiet_seconds;
      latest_ = now + wait_.quiet_seconds * kMostWaits;
    }
    if (now < std::min(due_, latest_)) return Act::kNone;
    Enter(Stage::kReceiving);
  }
  if (std::exchange(is_new_, false)) {
    ++token_;
    awaited_.clear();
    return Act::kEcho;
  }
  if (!awaited_.empty() && now < due_) return Act::kNone;
  missing_ += std::exchange(awaited_, {}).size();
  if (stage_ == Stage::kSending) {
    Enter(Stage::kAnswering);
    return Next(now);
  }
  stage_ = Stage::kNone;
  return Act::kContinue;
}

double AnswerRound::Rest(double now) const {
  if (stage_ == Stage::kNone) return std::numeric_limits<double>::infinity();
  if (is_new_) return 0.0;
  if (stage_ == Stage::kAnswering) {
    return std::max((wait_.is_lockstep ? due_ : std::min(due_, latest_)) - now, 0.0);
  }
  return awaited_.empty() ? 0.0 : std::max(due_ - now, 0.0);
}

void AnswerRound::Echoed(std::set<std::size_t> clients, double now) {
  awaited_ = std::move(clients);
  due_ = now + kLongestEcho;
}

void AnswerRound::Returned(std::size_t client, std::uint64_t token) {
  if (token == token_) awaited_.erase(client);
}

std::size_t AnswerRound::TakeMissing() {
  return std::exchange(missing_, 0);
}

void AnswerRound::Heard(double now) {
  if (stage_ == Stage::kAnswering && !wait_.is_lockstep && !is_new_) due_ = now + wait_.quiet_seconds;
}

void AnswerRound::Answered() {
  if (stage_ == Stage::kAnswering && wait_.is_lockstep) Enter(Stage::kReceiving);
}

void AnswerRound::End() {
  has_ended_ = true;
  Answered();
}

bool AnswerRound::TakeIsLate(double now) {
  if (stage_ != Stage::kAnswering || !wait_.is_lockstep || is_new_ || now < latest_) return false;
  return !std::exchange(has_told_late_, true);
}

}  // namespace troupe
