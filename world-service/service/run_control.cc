#include "world-service/service/run_control.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/base/text.h"
#include "world-service/core/edit_world.h"
#include "world-service/service/apply_edit.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxOpen = 1000;  // requests; a hostile tool may send any number

bool IsOver(const LiveRun& run) {
  return run.phase == RunPhase::kEnding || run.phase == RunPhase::kOver;
}

}  // namespace

void RunControl::Execute(const control::Request& request, ControlReplyTo reply, RequestedWorld world, double now) {
  OpenRequest open{request, std::move(reply), std::move(world)};
  // Also when the run is over or too many requests are open: a tool can always ask.
  if (control::Is<control::GetStatus>(request)) return Accept(open);
  if (IsOver(run_)) return Reply(open, BadInput("the run is over"));
  if (open_requests() + engine_.waiting_inputs() >= kMaxOpen) {
    return Reply(open, BadInput("too many requests are waiting"));
  }
  // What a request changes is that of the state before the rewind until it has ended.
  if (rewind_.is_running() && !control::Is<control::Entities>(request)) return early_.push_back(std::move(open));
  if (const Status malformed = control::CheckRequest(request); !malformed.ok()) return Reply(open, malformed.error());
  if (control::Is<control::Change>(request)) {
    return Reply(open, BadInput("controllers are changed when a run continues from a recording"));
  }
  // Checked twice: here, so that a wrong tick does not pause the run, and when the request is executed, because an edit
  // before it in the queue may have changed the tick.
  const auto* const rewind = std::get_if<control::Rewind>(&request);
  if (rewind != nullptr && run_.phase == RunPhase::kRunning) {
    if (const Status problem = CheckRewind(*rewind); !problem.ok()) return Reply(open, problem.error());
  }
  if (const auto* const restore = std::get_if<control::Restore>(&request)) {
    Result<std::shared_ptr<const WorldDescription>> deleted = editor_.Deleted(restore->source);
    if (!deleted.ok()) return Reply(open, deleted.error());
    open.world = {std::move(deleted).value()};
    // From here on a restored entity is a spawned one, with its description in place of a file. The recording has the
    // spawn.
    open.request = control::Spawn{.source = restore->source,
                                  .name = restore->name.empty() ? restore->source : restore->name,
                                  .pose = restore->pose};
  }
  switch (control::KindOf(open.request)) {
    case RequestKind::kEdit:
      return EnqueueEdit(std::move(open), now);
    case RequestKind::kInput:
      return ExecuteInput(std::move(open), now);
    case RequestKind::kQuestion:
      if (const auto* const query = std::get_if<control::Entities>(&request)) return Reply(open, Entities(*query));
      return Reply(open, BadInput("the service cannot read files here"));
    case RequestKind::kTime:
      break;
  }
  if (control::Is<control::Play>(request)) return Play(open, now);
  if (control::Is<control::Pause>(request)) return Pause(std::move(open), now);
  if (control::Is<control::Step>(request)) return EnqueueStep(std::move(open), now);
  if (const auto* const speed = std::get_if<control::Speed>(&request))
    return ReplyWith(open, SetSpeed(speed->speed, now));
  ExecuteInput(std::move(open), now);
}

Status RunControl::SetSpeed(const std::optional<double>& speed, double now) {
  if (!speed && run_.realtime()) return BadInput("mode realtime needs a speed");
  engine_.SetSpeed(speed, now);
  Remember(now);
  return {};
}

// So that what a tool was told outlives the service, also one that is still gathering the agents of a run that it
// continues. A branch has nothing to continue before its first state is recorded.
void RunControl::Remember(double now) {
  const bool gathers = run_.phase == RunPhase::kGathering && run_.takes_over();
  if (run_.phase == RunPhase::kRunning || gathers) engine_.ReportProgress(now);
}

Status RunControl::CommandRobot(const control::CommandRobot& request, double now) {
  const std::optional<RobotId> robot = FindRobot(run_.world(), request.name);
  if (!robot) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < run_.world().robots.size(); ++i) {
      if (RobotExists(run_.world(), RobotId(i))) names.push_back(run_.world().robots[i].name);
    }
    return BadInput("the world has no robot '" + request.name + "'" + DidYouMean(request.name, names));
  }
  RobotCommand command{*robot, request.twist, request.grippers, request.goal, request.messages};
  // A goal without waypoints is a cancellation; the check below accepts none, so it is set aside for the check.
  const bool cancels_goal = command.goal && command.goal->waypoints.empty();
  if (cancels_goal) command.goal.reset();
  if (Status failure = CheckRobotCommand(run_.world(), command); !failure.ok()) return failure;
  const std::string& controller = run_.world().robot(*robot).controller.name;
  const auto known = run_.accepts_goals.find(controller);
  if (command.goal && known != run_.accepts_goals.end() && !known->second) {
    return BadInput("the controller of '" + request.name + "' (" + controller + ") accepts no goals");
  }
  if (command.goal && run_.options.check_goal) {
    const Pose& X_WR = run_.frame.state.robots[robot->index()].X_WR;
    if (Status reason = run_.options.check_goal(*run_.scene, *robot, X_WR, *command.goal); !reason.ok()) {
      return BadInput("'" + request.name + "' cannot reach the goal: " + reason.error().message);
    }
  }
  if (cancels_goal) command.goal.emplace();
  engine_.AddCommand(command, request.ticks);
  engine_.ReportProgress(now);
  return {};
}

void RunControl::ExecuteInput(OpenRequest open, double now) {
  if (!has_begun()) return Reply(open, BadInput("the run has not begun; nothing can be changed before"));
  // A run that is continued: its inputs wait until the agents have rejoined, rather than being refused by chance.
  if (run_.phase == RunPhase::kGathering) return early_.push_back(std::move(open));
  const auto* const command = std::get_if<control::CommandRobot>(&open.request);
  ReplyWith(open, command != nullptr ? CommandRobot(*command, now) : AddInput(open.request, now));
}

Status RunControl::AddInput(const control::Request& request, double now) {
  const Result<Input> input = InputOf(*run_.scene, request);
  if (!input.ok()) return input.error();
  engine_.AddInput(input.value());
  editor_.ReportRequest(request);
  engine_.ReportProgress(now);  // so that it survives the service
  return {};
}

void RunControl::Pause(OpenRequest pause, double now) {
  // The pause was there for an edit only; from now on it is the user's, and the journal has to know it.
  const bool remains = run_.frame.paused && engine_.play_after_edits();
  engine_.SetPlayAfterEdits(false);
  if (remains) engine_.ReportProgress(now);
  if (engine_.holding()) {
    engine_.SetTicksToPause(0);
    engine_.ResendHold();
    engine_.ReportProgress(now);
    awaiting_pause_.push_back(std::move(pause));
    return Advance(now);
  }
  if (quiescent() && queue_.empty()) return Accept(pause);
  // The tick under way is completed: agents may have decided on it already.
  if (!run_.frame.paused) engine_.SetTicksToPause(has_begun() ? 1 : 0);
  awaiting_pause_.push_back(std::move(pause));
}

void RunControl::Play(const OpenRequest& play, double now) {
  // Each request is answered once: those that waited for the pause would wait without end.
  const Error superseded = BadInput("the run was set to play");
  for (const OpenRequest& waiting : std::exchange(awaiting_pause_, {})) Reply(waiting, superseded);
  std::erase_if(queue_, [&](const OpenRequest& waiting) {
    if (!control::Is<control::Step>(waiting.request)) return false;
    Reply(waiting, superseded);
    return true;
  });
  // Edits that were asked for before the play are executed first, in the order of the requests.
  engine_.SetPlayAfterEdits(edit_ || !queue_.empty());
  if (engine_.play_after_edits()) {
    if (!run_.frame.paused || engine_.holding()) engine_.RequestPause();
  } else {
    engine_.SetTicksToPause(std::nullopt);
    if (run_.frame.paused && run_.phase == RunPhase::kRunning) engine_.Resume(now);
  }
  Remember(now);
  Accept(play);
}

void RunControl::EnqueueStep(OpenRequest step, double now) {
  if (playing()) return Reply(step, BadInput("the run is playing; only a paused one can step"));
  Enqueue(std::move(step), now);
}

void RunControl::EnqueueEdit(OpenRequest edit, double now) {
  if (!has_begun()) {
    return Reply(edit, BadInput("the run has not begun; nothing can be changed before"));
  }
  if (!engine_.ticks_to_pause()) {
    engine_.SetPlayAfterEdits(true);
    engine_.RequestPause();
  }
  Enqueue(std::move(edit), now);
}

void RunControl::Enqueue(OpenRequest open, double now) {
  queue_.push_back(std::move(open));
  if (quiescent()) StartQueued(now);
}

void RunControl::Advance(double now) {
  if (IsOver(run_)) return RefuseAll(BadInput("the run is over"));
  if (run_.phase == RunPhase::kRunning && !rewind_.is_running()) {
    for (OpenRequest& open : std::exchange(early_, {})) {
      Execute(open.request, std::move(open.reply), std::move(open.world), now);
    }
  }
  if (!quiescent()) return;
  ReplyToWaiting();
  ReplyToEdit();
  StartQueued(now);
}

void RunControl::ReplyToWaiting() {
  for (OpenRequest& open : std::exchange(awaiting_pause_, {})) {
    const std::uint64_t made = run_.frame.state.tick - step_begun_;
    const auto* const step = std::get_if<control::Step>(&open.request);
    if (step != nullptr && made == step->ticks && !engine_.released()) {
      awaiting_pause_.push_back(std::move(open));  // its last tick is still awaited
    } else if (step != nullptr && made < step->ticks) {
      Reply(open, BadInput("paused after " + std::to_string(made) + " of " + std::to_string(step->ticks) + " ticks"));
    } else {
      Accept(open);
    }
  }
}

void RunControl::ReplyToEdit() {
  const std::optional<OpenRequest> edit = std::exchange(edit_, std::nullopt);
  if (!edit) return;
  const auto* const spawn = std::get_if<control::Spawn>(&edit->request);
  Reply(*edit, spawn != nullptr ? Entities({.name = spawn->name}) : std::vector<EntityReport>());
}

void RunControl::StartQueued(double now) {
  // Each applied edit asks the agents for an answer, so the loop ends after it unless the world has no agents.
  while (!queue_.empty() && quiescent() && engine_.observers_ready()) {
    // A step leaves the tick, so observers that await something for it (ROS nodes in lockstep) come first. An edit
    // stays.
    const bool is_step = control::Is<control::Step>(queue_.front().request);
    if (is_step && !engine_.released()) return;
    OpenRequest next = std::move(queue_.front());
    queue_.pop_front();
    if (is_step) return StartStep(std::move(next), now);
    StartEdit(std::move(next), now);
    if (edit_ && quiescent()) return Advance(now);  // no agent has to answer
  }
  if (!queue_.empty() || edit_ || !engine_.play_after_edits()) return;
  engine_.SetPlayAfterEdits(false);
  engine_.SetTicksToPause(std::nullopt);
  if (run_.phase == RunPhase::kRunning) engine_.Resume(now);
}

void RunControl::StartStep(OpenRequest step, double now) {
  // At the run's speed: a step of many ticks is watched like a run that plays.
  engine_.SetTicksToPause(std::get<control::Step>(step.request).ticks, Pace::kRun);
  step_begun_ = run_.frame.state.tick;
  awaiting_pause_.push_back(std::move(step));
  engine_.Resume(now);
}

Status RunControl::CheckRewind(const control::Rewind& rewind) const {
  if (!run_.options.has_history) {
    return BadInput("the run keeps no recording to be rewound by; start it with --record FILE.mcap");
  }
  if (rewind.tick <= run_.frame.state.tick) return {};
  return BadInput("found tick " + std::to_string(rewind.tick) + ", expected at most " +
                  std::to_string(run_.frame.state.tick) + ", the tick of the run");
}

void RunControl::AdvanceRewind(double now) {
  if (!rewind_.is_running()) return;
  const std::optional<Result<RewoundRun>> outcome = rewind_.Advance(IsOver(run_));
  if (!outcome || !edit_ || IsOver(run_)) return;  // the request was refused when the run ended
  if (outcome->ok()) {
    editor_.Rewind(edit_->request, outcome->value(), now);
  } else {
    const std::optional<OpenRequest> edit = std::exchange(edit_, std::nullopt);
    Reply(*edit, outcome->error());
  }
  Advance(now);
}

void RunControl::StartEdit(OpenRequest edit, double now) {
  if (const auto* const rewind = std::get_if<control::Rewind>(&edit.request)) {
    if (const Status problem = CheckRewind(*rewind); !problem.ok()) return Reply(edit, problem.error());
    rewind_.Start(*rewind, run_.frame);
    edit_ = std::move(edit);
    return;
  }
  Result<control::Request> applied = editor_.Apply(edit.request, edit.world, now);
  if (!applied.ok()) return Reply(edit, applied.error());
  edit.request = std::move(applied).value();
  edit_ = std::move(edit);
}

void RunControl::GiveUpNewRobots(const Error& error, double now) {
  const std::optional<OpenRequest> edit = std::exchange(edit_, std::nullopt);
  if (!edit) return;
  Reply(*edit, error);
  // The tool is told that its spawn failed, so no robot without an agent stays behind. Robots of a loaded world stay:
  // the world was asked for as a whole.
  if (const auto* const spawn = std::get_if<control::Spawn>(&edit->request)) editor_.RevokeSpawn(spawn->name, now);
}

Result<std::vector<EntityReport>> RunControl::Entities(const control::Entities& query) const {
  const std::string& name = query.name;
  std::vector<EntityReport> entities = ListEntities(run_.world(), run_.frame.state);
  if (!name.empty()) {
    const Result<ModelId> root = FindEntity(run_.world(), name);
    if (!root.ok()) {
      // A named place is not an entity, but a tool may ask for its pose by the same request.
      const std::vector<NamedPlace>& places = run_.world().places;
      const auto place =
          std::find_if(places.begin(), places.end(), [&](const auto& each) { return each.name == name; });
      if (place != places.end()) {
        return std::vector<EntityReport>{{.name = name, .type = "place", .X_WE = place->X_WN}};
      }
      // The levels of layouts, and the floors of lifts, have no model.
      const std::vector<LevelDescription>& levels = run_.world().levels;
      const auto level =
          std::find_if(levels.begin(), levels.end(), [&](const auto& each) { return each.name == name; });
      if (level == levels.end()) {
        std::vector<std::string> names;
        for (const NamedPlace& each : places) names.push_back(each.name);
        for (const LevelDescription& each : levels) names.push_back(each.name);
        const std::string similar = DidYouMean(name, names);
        return similar.empty() ? root.error() : BadInput("the world has no entity '" + name + "'" + similar);
      }
      std::vector<EntityReport> found{{.name = name, .type = "level", .X_WE = {0.0, 0.0, level->z, 0.0}}};
      SetSignals(run_.world(), run_.frame.state, found.front());
      return found;
    }
    std::erase_if(entities, [&](const EntityReport& entity) { return entity.name != name; });
    for (EntityReport& entity : entities) {
      SetSignals(run_.world(), run_.frame.state, entity);
      const std::optional<RobotId> robot = FindRobot(run_.world(), name);
      if (const std::string* const sent = run_.vehicle_states.Of(name)) SetVehicle(*sent, entity);
      if (const Event* const said = robot ? run_.events.LastSaid(*robot) : nullptr) SetSaid(*said, entity);
    }
  }
  SetAgents(run_.world(), run_.members, entities);
  if (query.with_boxes) SetBoxes(run_.world(), run_.frame.state, entities);
  return entities;
}

void RunControl::Reply(const ControlReplyTo& reply, const Result<std::vector<EntityReport>>& outcome) const {
  ControlReply content;
  content.done = outcome.ok();
  if (outcome.ok()) {
    content.entities = outcome.value();
  } else {
    content.problem = outcome.error().message;
    content.problem_code = outcome.error().code;
  }
  content.tick = run_.frame.state.tick;
  content.state_hash = run_.frame.state_hash;
  content.edition = run_.frame.edition;
  content.open_requests = static_cast<std::uint32_t>(open_requests());
  content.state = State();
  reply(content);
}

void RunControl::Reply(const OpenRequest& open, const Result<std::vector<EntityReport>>& outcome) const {
  Reply(open.reply, outcome);
}

void RunControl::ReplyWith(const OpenRequest& open, const Status& outcome) const {
  if (!outcome.ok()) return Reply(open, outcome.error());
  Accept(open);
}

RunState RunControl::State() const {
  switch (run_.phase) {
    case RunPhase::kGathering:
      return RunState::kStarting;
    case RunPhase::kRunning:
      return run_.frame.paused && !engine_.holding() && !engine_.play_after_edits() ? RunState::kPaused
                                                                                    : RunState::kPlaying;
    case RunPhase::kEnding:
    case RunPhase::kOver:
      break;
  }
  return RunState::kOver;
}

void RunControl::RefuseAll(const Error& error) {
  for (const OpenRequest& open : std::exchange(awaiting_pause_, {})) Reply(open, error);
  for (const OpenRequest& open : std::exchange(early_, {})) Reply(open, error);
  for (const OpenRequest& open : std::exchange(queue_, {})) Reply(open, error);
  if (const auto edit = std::exchange(edit_, std::nullopt)) Reply(*edit, error);
}

}  // namespace troupe
