#include "world-service/replay/restore_run.h"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <span>
#include <string>
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
    Result<ReplayedWorld> world = ReplayedWorld::At(recording, chunk);
    if (!world.ok()) return world.error();
    world_.emplace(std::move(world).value());
    reported_scene_ = world_->scene();
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
      if (tick_.edit && !observers_.empty()) {
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
      // Of a world from a text, models are spawned from the first file again if the journal lacks the text.
      const bool is_from_lost_text = edit.request.source.empty() && edit.world && !edit.world->models.empty();
      world_file_ = is_from_lost_text ? std::nullopt : std::optional(edit.request.source);
      world_text_ = edit.request.text;
    }
    if (edit.request.command == ControlCommand::kDelete && edit.world) {
      deleted_.push_back({edit.request.name, std::make_shared<const WorldDescription>(*edit.world)});
      if (deleted_.size() > kMostDeleted) deleted_.pop_front();
    }
  }

  Status Tell(std::span<const Proposal> proposals) {
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
    run.world_text = std::move(world_text_);
    run.deleted = std::move(deleted_);
    return run;
  }

  const Journal& journal_;
  const RunObservers& observers_;
  std::optional<ReplayedWorld> world_;
  std::shared_ptr<const Scene> reported_scene_;  // that the observers know
  RecordedTick tick_;
  std::uint64_t next_number_ = 0;
  std::optional<MemoryPlace> previous_;
  std::optional<ReportedEdit> edit_;
  std::optional<UnfinishedRewind> rewind_;
  std::uint64_t last_copy_ = 0;            // number of the last state of the newest rewind; 0: there was none
  std::optional<std::string> world_file_;  // as ResumedRun
  std::string world_text_;
  std::deque<DeletedEntity> deleted_;
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
