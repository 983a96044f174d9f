#include "world-service/replay/branched_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <span>
#include <utility>

#include "common/base/identity.h"
#include "recording/recording.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/replay/run_replay.h"
#include "world-service/service/apply_edit.h"

namespace troupe {
namespace {

// The state of a recording with which the new run begins.
struct Start {
  ReplayedWorld world;
  RecordedTick tick;  // without its inputs
  std::optional<ControllerCheckpoint> previous;
};

Result<Start> FindStart(const Recording& recording, const std::optional<Tick>& from) {
  const TickPlaces& places = recording.places();
  std::uint64_t time = places.end();
  if (from) {
    const std::optional<std::uint64_t> last = places.Last(*from);
    if (!last) {
      return Error{
          {recording.name()},
          fmt::format("found tick {}, expected at most {}, the last of the recording", *from, places.greatest())};
    }
    time = *last;
  }
  const std::size_t chunk = recording.KeyframeBefore(time).value_or(0);
  Result<ReplayedWorld> world = ReplayedWorld::At(recording, chunk);
  if (!world.ok()) return world.error();
  // The last state of the tick at that time, before another tick begins there.
  TickReader reader(recording, chunk);
  std::optional<Start> start;
  RecordedTick tick;
  for (;;) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error();
    if (!more.value() || tick.log_time > time) break;
    if (start && start->tick.log_time == time && from && tick.tick != *from) break;
    if (Status problem = world.value().Follow(tick); !problem.ok()) {
      return Error{
          {recording.name()}, fmt::format("tick {}: {}", tick.tick, problem.error().message), ErrorCode::kFailure};
    }
    if (from && (tick.log_time != time || tick.tick != *from)) continue;
    start.reset();
    start.emplace(Start{ReplayedWorld(world.value()), {}, PreviousOf(tick)});
    start->tick.number = tick.number;
    start->tick.tick = tick.tick;
    start->tick.edition = tick.edition;
    start->tick.log_time = tick.log_time;
  }
  if (!start) return Error{{recording.name()}, "the recording has no state to begin with", ErrorCode::kFailure};
  return std::move(*start);
}

Result<WorldChanges> ChangesOf(const BranchOptions& options, const WorldDescription& world) {
  WorldChanges changes;
  if (options.seed && *options.seed != world.seed) changes.seed = options.seed;
  for (const std::string& text : options.controllers) {
    Result<ControllerChange> change = ParseControllerChange(text);
    if (!change.ok()) return change.error();
    const std::string& name = change.value().robot;
    if (!name.empty() && !FindRobot(world, name)) {
      return Error{
          {}, fmt::format("option --controller: found robot '{}', which the world does not have at that tick", name)};
    }
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      const RobotDescription& robot = world.robots[i];
      if (!RobotExists(world, RobotId(i))) continue;
      const bool is_meant = name.empty() ? robot.controller == ControllerDescription() : robot.name == name;
      if (is_meant) changes.controllers[robot.name] = change.value().controller;
    }
  }
  return changes;
}

// The edit that makes the changes, as it is recorded.
RecordedTick RecordedChange(const WorldChanges& changes, const FrameMessage& frame, std::uint64_t number) {
  RecordedTick tick;
  tick.number = number;
  tick.tick = frame.state.tick;
  tick.edition = frame.edition + 1;
  tick.state_hash = frame.state_hash;
  RecordedEdit& edit = tick.edit.emplace();
  edit.before = frame;
  edit.request.command = ControlCommand::kChange;
  edit.request.source = changes.ToText();
  return tick;
}

class Restoration {
 public:
  Restoration(const Journal& journal, const MakeRunObservers& make_observers)
      : journal_(journal), make_observers_(make_observers) {}

  Result<ResumedRun> Run() {
    const Recording& recording = journal_.recording;
    if (Status version = CheckStepVersion(recording); !version.ok()) return version.error();
    const std::size_t chunk = make_observers_ == nullptr
                                  ? recording.KeyframeBefore(std::numeric_limits<std::uint64_t>::max()).value_or(0)
                                  : 0;
    Result<ReplayedWorld> world = ReplayedWorld::At(recording, chunk);
    if (!world.ok()) return world.error();
    world_.emplace(std::move(world).value());
    const Status visited = recording.VisitEdits(chunk, [this](std::uint64_t number, const RecordedEdit& edit) {
      Note(number, edit);
      return Status();
    });
    if (!visited.ok()) return visited.error();
    JournalReader reader(journal_, chunk);
    for (;;) {
      const Result<bool> more = reader.Next(tick_);
      if (!more.ok()) return more.error();
      if (!more.value()) break;
      if (Status failure = Apply(); !failure.ok()) return failure.error();
    }
    return Resumed();
  }

 private:
  // An edit of the run, for its observers.
  struct ReportedEdit {
    ControlRequest request;
    std::optional<WorldDescription> world;
    WorldState before;
  };

  Status Apply() {
    // The edits within a rewind are parts of it.
    if (!world_->in_rewind()) {
      edit_.reset();
      if (tick_.edit && make_observers_ != nullptr) {
        edit_ = ReportedEdit{tick_.edit->request, tick_.edit->world, world_->state()};
      }
    }
    if (tick_.edit) Note(tick_.number, *tick_.edit);
    const bool was_in_rewind = world_->in_rewind();
    if (Status problem = world_->Follow(tick_); !problem.ok()) {
      return Error{{journal_.recording.name()},
                   fmt::format("tick {}: {}", tick_.tick, problem.error().message),
                   ErrorCode::kFailure};
    }
    frame_ = world_->Frame();
    frame_->run = journal_.recording.run().run;
    next_number_ = tick_.number + 1;
    previous_ = PreviousOf(tick_);
    if (world_->in_rewind()) return {};
    rewind_.reset();
    if (!was_in_rewind) frame_->events = tick_.events;
    return Tell(was_in_rewind ? std::span<const Proposal>() : tick_.proposals);
  }

  // Edits whose effect is more than the state, also those before the keyframe.
  void Note(std::uint64_t number, const RecordedEdit& edit) {
    if (edit.request.command == ControlCommand::kRewind) {
      rewind_ = UnfinishedRewind{edit.request, number, edit.copied_from, edit.copies};
      last_copy_ = number + edit.copies;
    }
    if (number <= last_copy_) return;
    if (edit.request.command == ControlCommand::kLoadWorld) {
      // The journal lacks the text of a world that was no file: its models are spawned from the first file again.
      const bool is_from_lost_text = edit.request.source.empty() && edit.world && !edit.world->models.empty();
      world_file_ = is_from_lost_text ? std::nullopt : std::optional(edit.request.source);
    }
    if (edit.request.command == ControlCommand::kDelete && edit.world) {
      deleted_.push_back({edit.request.name, std::make_shared<const WorldDescription>(*edit.world)});
      if (deleted_.size() > kMaxDeleted) deleted_.pop_front();
    }
  }

  Status Tell(std::span<const Proposal> proposals) {
    if (make_observers_ == nullptr || tick_.number < journal_.progress.first_number) return {};
    if (reported_scene_ == nullptr) {
      Result<RunObservers> observers = make_observers_(world_->scene());
      if (!observers.ok()) return observers.error();
      observers_ = std::move(observers).value();
      reported_scene_ = world_->scene();
      edit_.reset();  // it led to the state that the run began with
    }
    std::optional<AppliedEdit> edit;
    if (edit_) edit.emplace(AppliedEdit{edit_->request, edit_->world ? &*edit_->world : nullptr});
    const CommittedTick tick{*frame_, proposals, edit ? &*edit : nullptr, edit ? &edit_->before : nullptr};
    const bool changed = std::exchange(reported_scene_, world_->scene()) != world_->scene();
    for (RunObserver* observer : observers_) {
      if (changed) observer->OnWorldChange(world_->scene(), tick_.edition);
      if (Status failure = observer->OnTick(tick); !failure.ok()) return failure;
    }
    return {};
  }

  ResumedRun Resumed() {
    ResumedRun run;
    run.run = journal_.recording.run().run;
    run.incarnation = journal_.progress.incarnation + 1;
    run.original = world_->original();
    run.scene = world_->scene();
    run.next_number = next_number_;
    run.previous = previous_;
    run.frame = std::move(frame_);
    run.progress = journal_.progress;
    run.rewind = std::move(rewind_);
    run.world_file = std::move(world_file_);
    run.deleted = std::move(deleted_);
    return run;
  }

  const Journal& journal_;
  const MakeRunObservers& make_observers_;
  RunObservers observers_;  // once the run has begun
  std::optional<ReplayedWorld> world_;
  std::shared_ptr<const Scene> reported_scene_;  // that the observers know; null: there are none yet
  RecordedTick tick_;
  std::uint64_t next_number_ = 0;
  std::optional<ControllerCheckpoint> previous_;
  std::optional<ReportedEdit> edit_;
  std::optional<UnfinishedRewind> rewind_;
  std::uint64_t last_copy_ = 0;            // number of the last state of the newest rewind; 0: there was none
  std::optional<std::string> world_file_;  // as ResumedRun
  std::deque<DeletedEntity> deleted_;
  std::optional<FrameMessage> frame_;
};

}  // namespace

Result<ControllerChange> ParseControllerChange(const std::string& text) {
  const std::size_t parameters = text.find(":{");
  const std::string names = text.substr(0, parameters);
  const std::size_t equals = names.find('=');
  ControllerChange change;
  if (equals != std::string::npos) change.robot = names.substr(0, equals);
  change.controller.name = equals == std::string::npos ? names : names.substr(equals + 1);
  if (parameters != std::string::npos) change.controller.parameters = text.substr(parameters + 1);
  if (change.controller.name.empty() || equals == 0) {
    return Error{{},
                 fmt::format("option --controller: found '{}', expected CONTROLLER or ROBOT=CONTROLLER, with "
                             ":{{...}} for parameters",
                             text)};
  }
  if (NamesLibrary(change.controller.name)) {
    change.controller.name = std::filesystem::absolute(change.controller.name).lexically_normal().string();
  }
  return change;
}

Result<BranchedRun> BranchRun(const std::string& file, const BranchOptions& options) {
  Result<Recording> opened = Recording::Open(file);
  if (!opened.ok()) return opened.error();
  const auto recording = std::make_shared<const Recording>(std::move(opened).value());
  if (Status version = CheckStepVersion(*recording); !version.ok()) return version.error();
  Result<Start> found = FindStart(*recording, options.from);
  if (!found.ok()) return found.error();
  Start& start = found.value();
  const Result<WorldChanges> changes = ChangesOf(options, start.world.world());
  if (!changes.ok()) return changes.error();

  FrameMessage frame = start.world.Frame();
  BranchedRun branch;
  auto begin = std::make_shared<RecordedStart>();
  begin->source = recording;
  begin->last_number = start.tick.number;
  branch.resumed.next_number = start.tick.number + 1;
  branch.resumed.previous = start.previous;
  if (changes.value().any()) {
    RecordedTick tick = RecordedChange(changes.value(), frame, branch.resumed.next_number++);
    if (Status refused = start.world.Apply(tick); !refused.ok()) return refused.error();
    frame.edition = frame.world_edition = tick.edition;
    branch.resumed.previous = PreviousOf(tick);
    begin->change = std::move(tick);
  }
  branch.begin = std::move(begin);
  branch.scene = start.world.scene();
  RunSettings& settings = branch.settings;
  settings = recording->run().settings;
  const bool has_own_end = settings.ticks && *settings.ticks <= frame.state.tick;
  if (has_own_end) settings.ticks.reset();
  options.run.ApplyTo(settings);
  if (settings.ticks && *settings.ticks <= frame.state.tick) {
    return Error{{},
                 fmt::format("option --ticks: found {}, expected more than {}, the tick from which the run continues",
                             *settings.ticks, frame.state.tick)};
  }
  ResumedRun& resumed = branch.resumed;
  resumed.run = MakeRandomId();
  resumed.is_branch = true;
  resumed.original = start.world.original();
  resumed.scene = branch.scene;
  resumed.frame = std::move(frame);
  if (options.paused) resumed.progress.ticks_to_pause = 0;
  resumed.progress.first_number = resumed.next_number - 1;
  resumed.world_file = recording->run().file;
  return branch;
}

std::optional<ControllerCheckpoint> PreviousOf(const RecordedTick& tick) {
  if (tick.number == 0) return std::nullopt;
  if (tick.edit) return ControllerCheckpoint{tick.edition - 1, tick.edit->before.state.tick, false};
  return ControllerCheckpoint{tick.edition, tick.tick - 1, true};
}

Result<ResumedRun> RestoreRun(const Journal& journal, const MakeRunObservers& make_observers) {
  return Restoration(journal, make_observers).Run();
}

}  // namespace troupe
