#include "world-service/replay/restore_run.h"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <utility>

#include "world-service/replay/replayed_world.h"
#include "world-service/replay/run_replay.h"

namespace troupe {
namespace {

class Restoration {
 public:
  Restoration(const Journal& journal, const RunObservers& observers) : journal_(journal), observers_(observers) {}

  Result<ResumedRun> Run() {
    const Recording& recording = journal_.recording;
    if (Status version = CheckStepVersion(recording); !version.ok()) return version.error();
    const std::size_t chunk =
        observers_.empty() ? recording.KeyframeBefore(std::numeric_limits<std::uint64_t>::max()).value_or(0) : 0;
    if (chunk > 0) {
      Result<ReplayedWorld> world = ReplayedWorld::At(recording, chunk);
      if (!world.ok()) return world.error();
      world_.emplace(std::move(world).value());
    } else {
      world_.emplace(recording);
    }
    JournalReader reader(journal_, chunk);
    for (bool restore = chunk > 0;; restore = false) {
      const Result<bool> more = reader.Next(tick_);
      if (!more.ok()) return more.error();
      if (!more.value()) break;  // the number of the tick remains
      if (Status failure = Apply(restore); !failure.ok()) return failure.error();
    }
    return Resumed();
  }

 private:
  Status Apply(bool restore) {
    const std::shared_ptr<const Scene> scene = world_->scene();
    const WorldState before = tick_.edit && !observers_.empty() ? world_->state() : WorldState();
    const Status applied = restore ? Restore() : world_->Apply(tick_);
    if (!applied.ok()) return Problem(applied.error().message);
    if (world_->state().tick != tick_.tick || world_->state_hash() != tick_.state_hash) {
      return Problem(
          fmt::format("found the state hash {:016x}, expected {:016x}", world_->state_hash(), tick_.state_hash));
    }
    FrameMessage& frame = frame_.emplace();
    frame.run = journal_.recording.run().run;
    frame.state = world_->state();
    frame.state_hash = world_->state_hash();
    frame.events = tick_.events;
    frame.edition = tick_.edition;
    frame.world_edition = world_->world_edition();
    frame.fresh_edition = world_->fresh_edition();
    return Tell(scene, before);
  }

  Status Restore() {
    return tick_.keyframe ? world_->Restore(*tick_.keyframe) : Status(Error{{}, "found no keyframe"});
  }

  Status Tell(const std::shared_ptr<const Scene>& scene, const WorldState& before) {
    std::optional<AppliedEdit> edit;
    if (tick_.edit) edit.emplace(AppliedEdit{tick_.edit->request, tick_.edit->world ? &*tick_.edit->world : nullptr});
    const CommittedTick tick{*frame_, tick_.proposals, edit ? &*edit : nullptr, edit ? &before : nullptr};
    for (RunObserver* observer : observers_) {
      if (world_->scene() != scene) observer->OnWorldChange(world_->scene(), tick_.edition);
      if (Status failure = observer->OnTick(tick); !failure.ok()) return failure;
    }
    return {};
  }

  Result<ResumedRun> Resumed() {
    ResumedRun run;
    run.run = journal_.recording.run().run;
    run.incarnation = journal_.progress.incarnation + 1;
    run.original = world_->original();
    run.scene = world_->scene();
    if (frame_) run.next_number = tick_.number + 1;
    if (frame_) run.previous = PreviousOf(tick_);
    run.frame = std::move(frame_);
    run.progress = journal_.progress;
    const auto note = [&run](const RecordedEdit& edit) {
      if (edit.request.command == ControlCommand::kLoadWorld) run.world_file = edit.request.source;
      return Status();
    };
    if (Status damaged = journal_.recording.VisitEdits(journal_.recording.chunks(), note); !damaged.ok()) {
      return damaged.error();
    }
    for (const RecordedTick& tick : journal_.tail) {
      if (tick.edit) static_cast<void>(note(*tick.edit));
    }
    return run;
  }

  Error Problem(const std::string& problem) const {
    return {{journal_.recording.name()}, fmt::format("tick {}: {}", tick_.tick, problem), ErrorCode::kFailure};
  }

  const Journal& journal_;
  const RunObservers& observers_;
  std::optional<ReplayedWorld> world_;
  RecordedTick tick_;
  std::optional<FrameMessage> frame_;
};

}  // namespace

std::optional<MemoryPlace> PreviousOf(const RecordedTick& tick) {
  if (tick.number == 0) return std::nullopt;
  if (tick.edit) return MemoryPlace{tick.edition - 1, tick.edit->before.state.tick, false};
  return MemoryPlace{tick.edition, tick.tick - 1, true};
}

Result<ResumedRun> RestoreRun(const Journal& journal, const RunObservers& observers) {
  return Restoration(journal, observers).Run();
}

}  // namespace troupe
