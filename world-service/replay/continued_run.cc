#include "world-service/replay/continued_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <span>
#include <utility>

#include "common/base/identity.h"
#include "recording/recording.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/service/apply_edit.h"

namespace troupe {
namespace {

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
      // Without a name the change is for idle robots only: it must not replace a controller that was chosen on purpose.
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
  edit.request = control::Change{changes.ToText()};
  return tick;
}

// The effects of a run's edits beyond its state, which later requests need.
class EditNotes {
 public:
  // `number`: of the state to which the edit led. In the order of the edits; a second call for one changes nothing.
  void Add(std::uint64_t number, const RecordedEdit& edit) {
    if (number < next_number_) return;
    next_number_ = number + 1;
    if (const auto* const rewind = std::get_if<control::Rewind>(&edit.request)) {
      rewind_ = UnfinishedRewind{*rewind, number, edit.copied_from, edit.copies, nullptr};
      // The edits within it are copies: they had their effect when they were made first.
      next_number_ += edit.copies;
    }
    if (const auto* const load = std::get_if<control::LoadWorld>(&edit.request)) {
      // The journal lacks the text of a world that was no file: its models are spawned from the first file again.
      const bool is_from_lost_text = load->source.empty() && edit.world && !edit.world->models.empty();
      world_file_ = is_from_lost_text ? std::nullopt : std::optional(load->source);
    }
    const auto* const removal = std::get_if<control::Delete>(&edit.request);
    if (removal != nullptr && edit.world) {
      deleted_.push_back({removal->name, std::make_shared<const WorldDescription>(*edit.world)});
      if (deleted_.size() > kMaxDeleted) deleted_.pop_front();
    }
  }

  // The newest rewind, if it has not ended; nothing: it has, or there was none.
  std::optional<UnfinishedRewind>& rewind() { return rewind_; }
  void MoveTo(ResumedRun& run) {
    run.rewind = std::move(rewind_);
    run.world_file = std::move(world_file_);
    run.deleted = std::move(deleted_);
  }

 private:
  std::uint64_t next_number_ = 0;  // of the first edit that is not noted yet
  std::optional<UnfinishedRewind> rewind_;
  std::optional<std::string> world_file_;  // as ResumedRun
  std::deque<DeletedEntity> deleted_;
};

class Restoration {
 public:
  Restoration(const Journal& journal, const MakeRunObservers& make_observers)
      : journal_(journal), make_observers_(make_observers) {}

  Result<ResumedRun> Run() {
    const Recording& recording = journal_.recording;
    if (Status version = CheckStepVersion(recording); !version.ok()) return version.error();
    // Observers get every tick of the run; without them the newest keyframe is enough.
    const Result<std::size_t> first = FirstChunk();
    if (!first.ok()) return first.error();
    const std::size_t chunk = first.value();
    Result<ReplayCursor> cursor = ReplayCursor::At(recording, chunk);
    if (!cursor.ok()) return cursor.error();
    cursor_.emplace(std::move(cursor).value());
    const Status visited = recording.VisitEdits(chunk, [this](std::uint64_t number, const RecordedEdit& edit) {
      notes_.Add(number, edit);
      return Status();
    });
    if (!visited.ok()) return visited.error();
    for (;;) {
      const Result<const RecordedTick*> next = cursor_->Next();
      if (!next.ok()) return next.error();
      if (next.value() == nullptr) break;
      if (Status failure = Advance(*next.value()); !failure.ok()) return failure.error();
    }
    return Resumed();
  }

 private:
  // An edit of the run, for its observers.
  struct ReportedEdit {
    control::Request request;
    std::optional<WorldDescription> world;
    WorldState before;
  };

  // The chunk to step from: before a rewind that has not ended, whose scene_before is needed.
  Result<std::size_t> FirstChunk() const {
    const Recording& recording = journal_.recording;
    if (make_observers_ != nullptr) return 0;
    std::uint64_t position = Recording::kEnd;
    if (journal_.progress.is_rewinding) {
      const Status visited = recording.VisitEdits(recording.chunks(), [&](std::uint64_t number, const auto& edit) {
        if (control::Is<control::Rewind>(edit.request)) position = number - 1;
        return Status();
      });
      if (!visited.ok()) return visited.error();
    }
    return recording.KeyframeUpTo(position);
  }

  // The state is one of a rewind whose end was not committed.
  bool IsOfUnfinishedRewind() {
    if (world().in_rewind()) return true;
    if (!journal_.progress.is_rewinding || !notes_.rewind()) return false;
    const Result<const RecordedTick*> next = cursor_->Next();
    return next.ok() && next.value() == nullptr;
  }

  Status Advance(const RecordedTick& next) {
    const bool was_in_rewind = world().in_rewind();
    // The edits within a rewind are parts of it.
    if (!was_in_rewind) {
      edit_.reset();
      if (next.edit && make_observers_ != nullptr) {
        edit_ = ReportedEdit{next.edit->request, next.edit->world, world().state()};
      }
    }
    if (next.edit) {
      notes_.Add(next.number, *next.edit);
      std::optional<UnfinishedRewind>& rewind = notes_.rewind();
      if (rewind && rewind->number == next.number) rewind->scene_before = world().scene();
    }
    if (Status problem = cursor_->Advance(); !problem.ok()) {
      return Error{{journal_.recording.name()}, problem.error().message, ErrorCode::kFailure};
    }
    const RecordedTick& tick = cursor_->tick();
    frame_ = world().Frame();
    // Recorded frames have no run id; agents ignore a frame without that of theirs.
    frame_->run = journal_.recording.run().run;
    if (IsOfUnfinishedRewind()) return {};
    notes_.rewind().reset();
    if (!was_in_rewind) frame_->events = tick.events;
    return Tell(tick, was_in_rewind ? std::span<const Proposal>() : tick.proposals);
  }

  Status Tell(const RecordedTick& tick, std::span<const Proposal> proposals) {
    if (make_observers_ == nullptr || tick.number < journal_.progress.first_number) return {};
    if (reported_scene_ == nullptr) {
      Result<RunObservers> observers = make_observers_(world().scene());
      if (!observers.ok()) return observers.error();
      observers_ = std::move(observers).value();
      reported_scene_ = world().scene();
      edit_.reset();  // it led to the state that the run began with
    }
    std::optional<AppliedEdit> edit;
    if (edit_) edit.emplace(AppliedEdit{edit_->request, edit_->world ? &*edit_->world : nullptr});
    const CommittedTick committed{*frame_, proposals, edit ? &*edit : nullptr, edit ? &edit_->before : nullptr};
    const bool changed = std::exchange(reported_scene_, world().scene()) != world().scene();
    for (RunObserver* observer : observers_) {
      if (changed) observer->OnWorldChange(world().scene(), tick.edition);
      if (Status failure = observer->OnTick(committed); !failure.ok()) return failure;
    }
    return {};
  }

  ResumedRun Resumed() {
    ResumedRun run;
    run.run = journal_.recording.run().run;
    run.incarnation = journal_.progress.incarnation + 1;
    run.original = world().original();
    run.scene = world().scene();
    run.next_number = cursor_->has_state() ? cursor_->position() + 1 : 0;
    if (cursor_->has_state()) run.previous = PreviousOf(cursor_->tick());
    run.frame = std::move(frame_);
    run.progress = journal_.progress;
    notes_.MoveTo(run);
    return run;
  }

  const ReplayedWorld& world() const { return cursor_->world(); }

  const Journal& journal_;
  const MakeRunObservers& make_observers_;
  RunObservers observers_;  // once the run has begun
  std::optional<ReplayCursor> cursor_;
  std::shared_ptr<const Scene> reported_scene_;  // that the observers know; null: there are none yet
  std::optional<ReportedEdit> edit_;
  EditNotes notes_;
  std::optional<FrameMessage> frame_;
};

}  // namespace

Result<ControllerChange> ParseControllerChange(const std::string& text) {
  // Parameters begin at the first ":{", because paths of libraries may contain a colon.
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
  Result<Recording> opened = OpenToReplay(file);
  if (!opened.ok()) return opened.error();
  const auto recording = std::make_shared<const Recording>(std::move(opened).value());
  const Result<ReplayCursor> found = ReplayCursor::AtTick(*recording, options.from);
  if (!found.ok()) return found.error();
  const ReplayCursor& start = found.value();
  ReplayedWorld world = start.world();
  const Result<WorldChanges> changes = ChangesOf(options, world.world());
  if (!changes.ok()) return changes.error();

  // As a service that continues the recorded run there would know them.
  EditNotes notes;
  const Status visited = recording->VisitEdits(recording->chunks(), [&](std::uint64_t number, const auto& edit) {
    if (number <= start.position()) notes.Add(number, edit);
    return Status();
  });
  if (!visited.ok()) return visited.error();
  FrameMessage frame = world.Frame();
  BranchedRun branch;
  notes.MoveTo(branch.resumed);
  branch.resumed.rewind.reset();  // the branch has the states of it that there are
  auto begin = std::make_shared<RecordedStart>();
  begin->source = recording;
  begin->last_number = start.position();
  branch.resumed.next_number = start.position() + 1;
  branch.resumed.previous = PreviousOf(start.tick());
  if (changes.value().any()) {
    RecordedTick tick = RecordedChange(changes.value(), frame, branch.resumed.next_number++);
    if (Status refused = world.Apply(tick); !refused.ok()) return refused.error();
    frame.edition = frame.world_edition = tick.edition;
    branch.resumed.previous = PreviousOf(tick);
    begin->change = std::move(tick);
  }
  branch.begin = std::move(begin);
  RunSettings& settings = branch.settings;
  settings = recording->run().settings;
  // A branch at or after the end of the recorded run continues without an end, unless the command line gives one.
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
  resumed.original = world.original();
  resumed.scene = world.scene();
  resumed.frame = std::move(frame);
  if (options.paused) resumed.progress.ticks_to_pause = 0;
  // Text files of the branch begin with its first own state, without states of the source.
  resumed.progress.first_number = resumed.next_number - 1;
  if (!resumed.world_file) resumed.world_file = recording->run().file;
  return branch;
}

Result<ResumedRun> RestoreRun(const Journal& journal, const MakeRunObservers& make_observers) {
  return Restoration(journal, make_observers).Run();
}

}  // namespace troupe
