// How a TickCoordinator edits its world. docs/tick-protocol.md describes editions.
#include <filesystem>
#include <string>
#include <utility>

#include "common/model/state_hash.h"
#include "world-service/service/entities.h"
#include "world-service/service/event_text.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe {
namespace {

// "scout" of "scout", "robots/scout.inc" or "robots.inc#scout".
std::string NameOfSource(const std::string& source) {
  const std::size_t hash = source.rfind('#');
  if (hash != std::string::npos) return source.substr(hash + 1);
  return std::filesystem::path(source).stem().string();
}

}  // namespace

void TickCoordinator::AskForEdit(OpenRequest open, double now) {
  if (phase_ == Phase::kGathering) return Answer(open, "the run has not begun; nothing can be changed before");
  if (!ticks_to_pause_) {
    play_after_edits_ = true;
    ticks_to_pause_ = 1;
  }
  queue_.push_back(std::move(open));
  if (settled()) Proceed(now);
}

Result<EditedWorld> TickCoordinator::Carry(OpenRequest& edit) const {
  ControlRequest& request = edit.request;
  switch (request.command) {
    case ControlCommand::kReset: {
      constexpr std::uint8_t kKnown = kResetTime | kResetState | kResetSpawned;
      if (request.scopes == kResetAll) return ResetWorld(original_, scene_, frame_.state, {});
      if (request.scopes == 0 || (request.scopes & ~kKnown) != 0) {
        return Error{{}, "found the scopes " + std::to_string(request.scopes) + ", expected 1 to 7, or 255"};
      }
      return ResetWorld(original_, scene_, frame_.state,
                        {.time = (request.scopes & kResetTime) != 0,
                         .state = (request.scopes & kResetState) != 0,
                         .spawned = (request.scopes & kResetSpawned) != 0,
                         .deleted = false});
    }
    case ControlCommand::kSetPose:
      return SetPose(scene_, frame_.state, request.name, request.pose);
    case ControlCommand::kDelete:
      return DeleteEntity(scene_, frame_.state, request.name);
    case ControlCommand::kSpawn:
      if (edit.world == nullptr) return Error{{}, "found nothing to spawn"};
      if (request.name.empty()) {
        request.name = FreeName(scene_->world(), NameOfSource(request.source));
      } else if (request.rename) {
        request.name = FreeName(scene_->world(), request.name);
      }
      return SpawnEntity(scene_, frame_.state, *edit.world, request.name, request.pose);
    case ControlCommand::kLoadWorld: {
      if (edit.world == nullptr) return Error{{}, "found no world"};
      EditedWorld loaded;
      loaded.scene = std::make_shared<const Scene>(*edit.world);
      loaded.state = InitialState(*edit.world);
      loaded.fresh = true;
      return loaded;
    }
    default:
      return Error{{}, "found no edit"};
  }
}

void TickCoordinator::StartEdit(OpenRequest edit, double now) {
  Result<EditedWorld> edited = Carry(edit);
  if (!edited.ok()) return Answer(edit, edited.error().message);
  Note(edit.request);
  if (edit.request.command == ControlCommand::kLoadWorld) original_ = edited.value().scene;
  edit_ = std::move(edit);
  TakeOver(std::move(edited).value(), now);
}

void TickCoordinator::Note(const ControlRequest& request) {
  std::string what = "tick " + std::to_string(frame_.state.tick) + ": ";
  switch (request.command) {
    case ControlCommand::kReset:
      what += "the world is reset";
      break;
    case ControlCommand::kLoadWorld:
      what += "the world is changed for " + request.source;
      break;
    case ControlCommand::kSpawn:
      what += "'" + request.name + "' is spawned";
      break;
    case ControlCommand::kDelete:
      what += "'" + request.name + "' is deleted";
      break;
    case ControlCommand::kSetPose:
      what += "'" + request.name + "' is put elsewhere";
      break;
    default:
      break;
  }
  if (notices_.size() < kNoticesKept) notices_.push_back(std::move(what));
}

// The edited world is the one to go on from. The pause stays until everybody has it.
void TickCoordinator::TakeOver(EditedWorld edited, double now) {
  ++frame_.edition;
  if (edited.fresh) frame_.fresh_edition = frame_.edition;
  if (edited.scene != scene_) {
    ChangeWorld(std::move(edited.scene), edited.fresh);
  } else {
    proposals_.ChangeWorld(scene_->world());
  }
  newcomers_since_ = now;
  if (members_.present_members() == 0) halted_since_ = now;
  frame_.state = std::move(edited.state);
  frame_.state_hash = StateHash(frame_.state);
  frame_.events = events_.TakeForFrame(frame_.state.tick, std::move(edited.events));
  frame_.paused = true;
  ticks_to_pause_ = 0;
  Publish(now);
}

void TickCoordinator::ChangeWorld(std::shared_ptr<const Scene> scene, bool fresh) {
  const std::shared_ptr<const Scene> before = std::exchange(scene_, std::move(scene));
  const WorldDescription& world = scene_->world();
  bodies_ = BodyIndex(*scene_);
  frame_.world_edition = frame_.edition;
  if (fresh) {
    // Ids mean something else from now on.
    for (const Event& event : events_.TakeUntold()) notices_.push_back(EventText(before->world(), event));
    events_.Forget();
  }
  Membership::WorldChange change = members_.ChangeWorld(world, frame_.edition, fresh);
  for (const AgentId agent : change.gone) barrier_.RemoveMember(agent);
  for (const RobotId robot : change.newcomers) new_robots_.push_back(world.robot(robot).name);
  newcomers_ = std::move(change.newcomers);
  proposals_.ChangeWorld(world);
  pacer_.SetInterval(world.interval_seconds());
  if (gateway_ != nullptr) gateway_->ChangeWorld(scene_);
  recorder_.ChangeWorld(world, frame_.edition);
  Announce();
}

// Agents that were started for new robots have not come.
void TickCoordinator::GiveUpNewcomers(double now) {
  const double timeout = options_.start_timeout_seconds;
  if (newcomers_.empty() || timeout <= 0.0 || now - newcomers_since_ < timeout) return;
  const std::string problem = "no agent came for " + ListNames(std::exchange(newcomers_, {})) + " within " +
                              std::to_string(static_cast<int>(timeout)) + " s";
  notices_.push_back(problem);
  if (const auto edit = std::exchange(edit_, std::nullopt)) {
    Answer(*edit, problem);
    if (edit->request.command == ControlCommand::kSpawn) return Unspawn(edit->request.name, now);
  }
  if (settled()) Settle(now);
}

void TickCoordinator::Unspawn(const std::string& name, double now) {
  Result<EditedWorld> without = DeleteEntity(scene_, frame_.state, name);
  if (!without.ok()) return;
  TakeOver(std::move(without).value(), now);
  if (settled()) Settle(now);
}

void TickCoordinator::AnswerEdit(const OpenRequest& edit) const {
  std::vector<EntityReport> entities;
  if (edit.request.command == ControlCommand::kSpawn) {
    entities = ListEntities(scene_->world(), frame_.state);
    std::erase_if(entities, [&](const EntityReport& entity) { return entity.name != edit.request.name; });
  }
  Answer(edit, "", std::move(entities));
}

}  // namespace troupe
