// How a TickCoordinator pauses, plays and steps. docs/tick-protocol.md describes the pause.
#include <algorithm>
#include <string>
#include <utility>

#include "world-service/service/entities.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe {
namespace {

constexpr std::size_t kMostOpen = 1000;  // requests; a hostile tool may send any number

}  // namespace

void TickCoordinator::Control(const ControlRequest& request, ControlReplyTo reply, double now, RequestedWorld world) {
  OpenRequest open{request, std::move(reply), std::move(world)};
  if (request.command == ControlCommand::kStatus) return Answer(open, "");
  if (phase_ == Phase::kEnding || phase_ == Phase::kOver) return Answer(open, "the run is over");
  if (queue_.size() + awaiting_pause_.size() >= kMostOpen) return Answer(open, "too many requests are waiting");
  switch (request.command) {
    case ControlCommand::kStatus:
      return;
    case ControlCommand::kPlay:
      return Play(open, now);
    case ControlCommand::kPause:
      play_after_edits_ = false;
      if (settled() && queue_.empty()) return Answer(open, "");
      if (!frame_.paused) ticks_to_pause_ = started_at_ ? 1 : 0;
      awaiting_pause_.push_back(std::move(open));
      return;
    case ControlCommand::kStep:
      if (request.ticks == 0) return Answer(open, "found 0 ticks to step, expected at least 1");
      if (playing()) return Answer(open, "the run is playing; only a paused one can step");
      queue_.push_back(std::move(open));
      if (settled()) Proceed(now);
      return;
    case ControlCommand::kReset:
    case ControlCommand::kLoadWorld:
    case ControlCommand::kSpawn:
    case ControlCommand::kDelete:
    case ControlCommand::kSetPose:
      return AskForEdit(std::move(open), now);
    case ControlCommand::kEntities:
      return AnswerEntities(open);
    case ControlCommand::kSpawnables:
      return Answer(open, "expected nobody to ask here");  // what files say is not known here
  }
}

void TickCoordinator::Play(const OpenRequest& open, double now) {
  for (const OpenRequest& waiting : std::exchange(awaiting_pause_, {})) Answer(waiting, "the run was set to play");
  std::erase_if(queue_, [this](const OpenRequest& waiting) {
    if (waiting.request.command != ControlCommand::kStep) return false;
    Answer(waiting, "the run was set to play");
    return true;
  });
  play_after_edits_ = edit_ || !queue_.empty();
  if (play_after_edits_) {
    if (!frame_.paused) ticks_to_pause_ = 1;
  } else {
    ticks_to_pause_.reset();
    if (frame_.paused) Resume(now);
  }
  Answer(open, "");
}

void TickCoordinator::Settle(double now) {
  AnswerPaused();
  if (const auto edit = std::exchange(edit_, std::nullopt)) AnswerEdit(*edit);
  Proceed(now);
}

void TickCoordinator::AnswerPaused() {
  for (const OpenRequest& open : std::exchange(awaiting_pause_, {})) {
    const std::uint64_t made = frame_.state.tick - step_begun_;
    const bool cut_short = open.request.command == ControlCommand::kStep && made < open.request.ticks;
    const std::string problem =
        "paused after " + std::to_string(made) + " of " + std::to_string(open.request.ticks) + " ticks";
    Answer(open, cut_short ? problem : "");
  }
}

void TickCoordinator::Proceed(double now) {
  while (!queue_.empty() && settled()) {
    OpenRequest next = std::move(queue_.front());
    queue_.pop_front();
    if (next.request.command == ControlCommand::kStep) return StartStep(std::move(next), now);
    StartEdit(std::move(next), now);
    if (edit_ && settled()) return Settle(now);  // there is nobody to wait for
  }
  if (!queue_.empty() || edit_ || !play_after_edits_) return;
  play_after_edits_ = false;
  ticks_to_pause_.reset();
  if (phase_ == Phase::kRunning) Resume(now);
}

void TickCoordinator::StartStep(OpenRequest step, double now) {
  ticks_to_pause_ = step.request.ticks;
  step_begun_ = frame_.state.tick;
  awaiting_pause_.push_back(std::move(step));
  Resume(now);
}

void TickCoordinator::Reply(const ControlRequest& request, const ControlReplyTo& reply,
                            std::vector<EntityReport> entities) const {
  Answer({request, reply}, "", std::move(entities));
}

void TickCoordinator::Refuse(const ControlRequest& request, const ControlReplyTo& reply,
                             const std::string& problem) const {
  Answer({request, reply}, problem);
}

void TickCoordinator::AnswerEntities(const OpenRequest& open) const {
  const std::string& name = open.request.name;
  const WorldDescription& world = scene_->world();
  if (name.empty()) return Answer(open, "", ListEntities(world, frame_.state));
  const Result<ModelId> root = FindEntity(world, name);
  if (!root.ok()) return Answer(open, root.error().message);
  std::vector<EntityReport> entities = ListEntities(world, frame_.state);
  std::erase_if(entities, [&](const EntityReport& entity) { return entity.name != name; });
  Answer(open, "", std::move(entities));
}

void TickCoordinator::Answer(const OpenRequest& open, const std::string& problem,
                             std::vector<EntityReport> entities) const {
  ControlReply reply;
  reply.entities = std::move(entities);
  reply.client = open.request.client;
  reply.number = open.request.number;
  reply.done = problem.empty();
  reply.problem = problem;
  reply.tick = frame_.state.tick;
  reply.state_hash = frame_.state_hash;
  reply.edition = frame_.edition;
  switch (phase_) {
    case Phase::kGathering:
      reply.state = RunState::kStarting;
      break;
    case Phase::kRunning:
      reply.state = frame_.paused && !play_after_edits_ ? RunState::kPaused : RunState::kPlaying;
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
  for (const OpenRequest& open : std::exchange(queue_, {})) Answer(open, problem);
  if (const auto edit = std::exchange(edit_, std::nullopt)) Answer(*edit, problem);
}

}  // namespace troupe
