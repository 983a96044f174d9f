// How a TickCoordinator pauses, plays and steps. docs/tick-protocol.md describes the pause.
#include <utility>

#include "world-service/service/tick_coordinator.h"

namespace troupe {
namespace {

constexpr std::size_t kMostOpen = 1000;  // requests; a hostile tool may send any number

}  // namespace

void TickCoordinator::Control(const ControlRequest& request, ControlReplyTo reply, double now) {
  OpenRequest open{request, std::move(reply)};
  if (request.command == ControlCommand::kStatus) return Answer(open, "");
  if (phase_ == Phase::kEnding || phase_ == Phase::kOver) return Answer(open, "the run is over");
  if (steps_.size() + awaiting_pause_.size() >= kMostOpen) return Answer(open, "too many requests are waiting");
  switch (request.command) {
    case ControlCommand::kStatus:
      return;
    case ControlCommand::kPlay:
      AnswerAll("the run was set to play");
      ticks_to_pause_.reset();
      if (frame_.paused) Resume(now);
      return Answer(open, "");
    case ControlCommand::kPause:
      if (settled()) return Answer(open, "");
      if (!frame_.paused) ticks_to_pause_ = started_at_ ? 1 : 0;
      awaiting_pause_.push_back(std::move(open));
      return;
    case ControlCommand::kStep:
      if (request.ticks == 0) return Answer(open, "found 0 ticks to step, expected at least 1");
      if (!ticks_to_pause_) return Answer(open, "the run is playing; only a paused one can step");
      steps_.push_back(std::move(open));
      if (settled()) StartStep(now);
      return;
  }
}

void TickCoordinator::Settle(double now) {
  for (const OpenRequest& open : std::exchange(awaiting_pause_, {})) Answer(open, "");
  if (!steps_.empty()) StartStep(now);
}

void TickCoordinator::StartStep(double now) {
  ticks_to_pause_ = steps_.front().request.ticks;
  awaiting_pause_.push_back(std::move(steps_.front()));
  steps_.pop_front();
  Resume(now);
}

void TickCoordinator::Answer(const OpenRequest& open, const std::string& problem) const {
  ControlReply reply;
  reply.client = open.request.client;
  reply.number = open.request.number;
  reply.done = problem.empty();
  reply.problem = problem;
  reply.tick = frame_.state.tick;
  reply.state_hash = frame_.state_hash;
  switch (phase_) {
    case Phase::kGathering:
      reply.state = RunState::kStarting;
      break;
    case Phase::kRunning:
      reply.state = frame_.paused ? RunState::kPaused : RunState::kPlaying;
      break;
    case Phase::kEnding:
    case Phase::kOver:
      reply.state = RunState::kOver;
      break;
  }
  open.reply(reply);
}

void TickCoordinator::AnswerAll(const std::string& problem) {
  for (const OpenRequest& open : std::exchange(awaiting_pause_, {})) Answer(open, problem);
  for (const OpenRequest& open : std::exchange(steps_, {})) Answer(open, problem);
}

}  // namespace troupe
