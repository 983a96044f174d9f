#include "world-service/replay/journal_rewind.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "world-service/replay/journal_history.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {
namespace {

class JournalRewind final : public RewindStates {
 public:
  explicit JournalRewind(const std::vector<RunRecorder*>& recorders) : past_(recorders) {}

  // One of them, first. As StartRewind; or the rest of a rewind within which a service died, whose newest state that
  // was written is that of the run.
  Status Start(const control::Rewind& request, const FrameMessage& newest);
  Status Continue(const ResumedRun& run);

  Result<bool> MakeSome() override;
  Result<RewoundRun> Write() override;

 private:
  enum class Stage : std::uint8_t {
    kFinding,  // the last state of the tick, and with it the edition at which its robots were made
    kSeeking,  // the first state of that edition
    kMaking,   // the states from there to the last
    kMade,
  };

  Status Find();
  Status StartSeeking(Edition edition);
  Status Seek();
  // The edit that restores the first state.
  RecordedTick FirstTick() const;
  Status WriteTo(RunRecorder& recorder) const;
  // The editions of the copies follow the run's.
  Edition Shift(Edition edition) const { return std::max(edition, first_edition_) - first_edition_ + shifted_; }
  void Shift(FrameMessage& frame) const;
  FrameMessage CopiedFrame() const;

  OwnRecording past_;  // its cursor is at the state that was made last
  Stage stage_ = Stage::kFinding;
  control::Rewind request_;
  FrameMessage newest_;      // of the run
  std::uint64_t first_ = 0;  // the positions of the first state, and of that of the tick
  std::uint64_t last_ = 0;
  Edition first_edition_ = 0;               // of the first state, when it was recorded
  Edition shifted_ = 0;                     // of its copy
  std::size_t first_chunk_ = 0;             // from which the first state was found
  std::optional<RecordedTick> first_tick_;  // nothing: a service has written it
  std::optional<std::uint64_t> copies_;  // that follow the first state, as a service has written; nothing: it has not
  std::uint64_t written_ = 0;            // of these
};

Status JournalRewind::Start(const control::Rewind& request, const FrameMessage& newest) {
  if (Status failure = past_.Open(); !failure.ok()) return failure;
  const std::optional<std::uint64_t> last = past_.recording().spans().Last(request.tick);
  if (!last) return Error{{}, fmt::format("the recording of the run has no tick {}", request.tick)};
  request_ = request;
  newest_ = newest;
  newest_.events.clear();
  last_ = *last;
  shifted_ = newest.edition + 1;
  return past_.Approach(last_);
}

Status JournalRewind::Continue(const ResumedRun& run) {
  if (Status failure = past_.Open(); !failure.ok()) return failure;
  newest_ = *run.frame;
  shifted_ = run.frame->fresh_edition;
  copies_ = run.rewind->copies;
  written_ = run.next_number - run.rewind->number - 1;
  return StartSeeking(run.rewind->copied_from);
}

Result<bool> JournalRewind::MakeSome() {
  Status failure;
  switch (stage_) {
    case Stage::kFinding:
      failure = Find();
      break;
    case Stage::kSeeking:
      failure = Seek();
      break;
    case Stage::kMaking:
      failure = past_.Advance();
      if (failure.ok() && past_.cursor().position() == last_) stage_ = Stage::kMade;
      break;
    case Stage::kMade:
      break;
  }
  if (!failure.ok()) return failure.error();
  return stage_ != Stage::kMade;
}

Status JournalRewind::Find() {
  if (!past_.cursor().has_state() || past_.cursor().position() < last_) return past_.Advance();
  if (past_.cursor().tick().tick != request_.tick)
    return past_.Broken(fmt::format("tick {} is missing", request_.tick));
  return StartSeeking(past_.world().fresh_edition());
}

Status JournalRewind::StartSeeking(Edition edition) {
  stage_ = Stage::kSeeking;
  // Robots of the tick begin at this edition; their memory needs all states from there on.
  first_edition_ = edition;
  // The edit that made the robots is stepped, too.
  const std::uint64_t first = past_.recording().spans().BeginOf(edition);
  if (first > 0) first_chunk_ = past_.recording().KeyframeUpTo(first - 1);
  return past_.Restart(first_chunk_);
}

Status JournalRewind::Seek() {
  if (Status broken = past_.Advance(); !broken.ok()) return broken;
  if (past_.world().edition() < first_edition_) return {};
  first_ = past_.cursor().position();
  if (copies_) {
    last_ = first_ + *copies_;
  } else {
    first_tick_ = FirstTick();
  }
  stage_ = first_ == last_ ? Stage::kMade : Stage::kMaking;
  return {};
}

Result<RewoundRun> JournalRewind::Write() {
  for (RunRecorder* const recorder : past_.recorders()) {
    if (Status failure = WriteTo(*recorder); !failure.ok()) return failure.error();
  }
  RewoundRun end{past_.world().scene(), past_.world().original(), CopiedFrame(), std::nullopt};
  if (last_ != first_) end.previous = PreviousOf(past_.cursor().tick());
  if (end.previous) end.previous->edition = Shift(end.previous->edition);
  return end;
}

Status JournalRewind::WriteTo(RunRecorder& recorder) const {
  TickReader reader(past_.recording(), first_chunk_);
  bool has_begun = !first_tick_;
  std::uint64_t newest = first_ + written_;
  return recorder.AppendRewind([&](RecordedTick& tick) -> Result<bool> {
    if (!std::exchange(has_begun, true)) {
      tick = *first_tick_;
      return true;
    }
    if (newest == last_) return false;
    do {
      const Result<bool> more = reader.Next(tick);
      if (!more.ok() || !more.value()) return past_.Broken(more.ok() ? "a state is missing" : more.error().message);
    } while (tick.number <= newest);
    newest = tick.number;
    // Editions of a run never decrease, so the copies get new ones.
    tick.edition = Shift(tick.edition);
    if (tick.edit) Shift(tick.edit->before);
    if (tick.keyframe) Shift(*tick.keyframe);
    return true;
  });
}

void JournalRewind::Shift(FrameMessage& frame) const {
  frame.run = newest_.run;
  for (Edition* edition : {&frame.edition, &frame.world_edition, &frame.fresh_edition}) *edition = Shift(*edition);
}

FrameMessage JournalRewind::CopiedFrame() const {
  FrameMessage frame = past_.world().Frame();
  Shift(frame);
  return frame;
}

RecordedTick JournalRewind::FirstTick() const {
  const ReplayedWorld& world = past_.world();
  const FrameMessage frame = CopiedFrame();
  RecordedTick tick;
  tick.tick = frame.state.tick;
  tick.edition = frame.edition;
  tick.state_hash = frame.state_hash;
  RecordedEdit& edit = tick.edit.emplace();
  edit.before = newest_;
  edit.request = request_;
  edit.world = world.world();
  if (world.original() != world.scene()) edit.original = world.original()->world();
  edit.restored = frame;
  // So that a service that continues the run knows how many copies belong to the rewind, if this one dies among them.
  edit.copies = last_ - first_;
  edit.copied_from = first_edition_;
  return tick;
}

// The progress of a run behind a rewind, as WorldEditor and TickEngine make it: robots that were not there before need
// an agent. Its recorder has dropped the commands and inputs.
void RewindProgress(const WorldDescription& before, ResumedRun& run) {
  const WorldDescription& world = run.scene->world();
  RunProgress& progress = run.progress;
  std::vector<RobotId> absent;
  for (const RobotId robot : std::exchange(progress.absent, {})) {
    const std::optional<RobotId> now = FindRobot(world, before.robot(robot).name);
    if (now && RobotExists(world, *now)) absent.push_back(*now);
  }
  std::sort(absent.begin(), absent.end());
  progress.absent = std::move(absent);
  progress.newcomers.clear();
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (RobotExists(world, RobotId(i)) && !FindRobot(before, world.robots[i].name)) {
      progress.newcomers.emplace_back(i);
    }
  }
  progress.is_rewinding = false;
}

}  // namespace

Result<std::unique_ptr<RewindStates>> StartRewind(const std::vector<RunRecorder*>& recorders,
                                                  const control::Rewind& request, const FrameMessage& newest) {
  auto rewind = std::make_unique<JournalRewind>(recorders);
  if (Status failure = rewind->Start(request, newest); !failure.ok()) return failure.error();
  return std::unique_ptr<RewindStates>(std::move(rewind));
}

Status FinishRewind(ResumedRun& run, RunRecorder& recorder, RunObservers observers) {
  recorder.StartWriting();
  JournalRewind states({&recorder});
  if (Status failure = states.Continue(run); !failure.ok()) return failure;
  for (Result<bool> more = true; more.value();) {
    more = states.MakeSome();
    if (!more.ok()) return more.error();
  }
  Result<RewoundRun> end = states.Write();
  if (!end.ok()) return end.error();
  const UnfinishedRewind rewind = *std::exchange(run.rewind, std::nullopt);
  const WorldState before = std::move(run.frame->state);
  run.frame = std::move(end.value().frame);
  run.scene = end.value().scene;
  run.original = end.value().original;
  run.previous = end.value().previous;
  run.next_number = rewind.number + rewind.copies + 1;
  if (rewind.scene_before != nullptr) RewindProgress(rewind.scene_before->world(), run);
  run.progress.incarnation = run.incarnation;
  const AppliedEdit edit{rewind.request};
  const CommittedTick tick{.frame = *run.frame, .proposals = {}, .edit = &edit, .before = &before, .is_recorded = true};
  observers.push_back(&recorder);
  for (RunObserver* observer : observers) {
    observer->OnWorldChange(run.scene, run.frame->edition);
    if (Status failure = observer->OnCommit(tick, run.progress); !failure.ok()) return failure;
    if (Status failure = observer->OnTick(tick); !failure.ok()) return failure;
  }
  return {};
}

}  // namespace troupe
