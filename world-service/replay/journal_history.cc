#include "world-service/replay/journal_history.h"

#include <fmt/format.h>

#include <utility>

#include "world-service/service/apply_edit.h"

namespace troupe {
namespace {

// The entries of one batch: a message that any receiver can process, for which an agent works some ms.
constexpr std::size_t kMaxEntries = 500;
constexpr std::size_t kMaxBytes = std::size_t{256} << 10;  // estimated

Error BrokenRecording(const std::vector<RunRecorder*>& recordings, const std::string& problem) {
  return {{recordings.back()->path()}, "the recording of this run cannot be read: " + problem, ErrorCode::kFailure};
}

// With all ticks of the run so far.
Result<std::unique_ptr<const Recording>> OpenRecordingOf(const std::vector<RunRecorder*>& recordings) {
  if (Status flushed = recordings.back()->Flush(); !flushed.ok()) return flushed.error();
  Result<Recording> recording = Recording::Open(recordings.back()->path());
  if (!recording.ok()) return BrokenRecording(recordings, recording.error().message);
  return std::make_unique<const Recording>(std::move(recording).value());
}

}  // namespace

std::unique_ptr<RunHistory> MakeRunHistory(const std::vector<RunRecorder*>& recordings) {
  if (recordings.empty()) return nullptr;
  return std::make_unique<JournalHistory>(recordings);
}

Error JournalHistory::Broken(const std::string& problem) const {
  return BrokenRecording(recordings_, problem);
}

Status JournalHistory::Open() {
  cursor_.reset();
  recording_.reset();
  Result<std::unique_ptr<const Recording>> recording = OpenRecordingOf(recordings_);
  if (!recording.ok()) return recording.error();
  recording_ = std::move(recording).value();
  return FindChanges();
}

Status JournalHistory::FindChanges() {
  changed_.clear();
  const Status visited = recording_->VisitEdits(recording_->chunks(), [this](std::uint64_t, const RecordedEdit& edit) {
    const auto* const change = std::get_if<control::Change>(&edit.request);
    if (change == nullptr) return Status();
    const Result<WorldChanges> changes = WorldChanges::FromText(change->changes);
    if (!changes.ok()) return Status(changes.error());
    for (const auto& [robot, controller] : changes.value().controllers) changed_[robot] = edit.before.edition + 1;
    return Status();
  });
  return visited.ok() ? visited : Status(Broken(visited.error().message));
}

WorldDescription JournalHistory::WorldToSend() const {
  WorldDescription world = cursor_->world().world();
  for (RobotDescription& robot : world.robots) {
    // A branch has changed the controller later: in the states before, the robot's controller was another one, whose
    // memory is dropped at the change. So the agent need not have that controller's library at all.
    const auto changed = changed_.find(robot.name);
    if (changed != changed_.end() && cursor_->world().edition() < changed->second) robot.controller = {};
  }
  return world;
}

Result<const RecordedTick*> JournalHistory::Next() {
  Result<const RecordedTick*> next = cursor_->Next();
  return next.ok() ? next : Broken(next.error().message);
}

Status JournalHistory::Advance() {
  const Status problem = cursor_->Advance();
  return problem.ok() ? problem : Broken(problem.error().message);
}

Status JournalHistory::Seek(const HistoryRequest& request) {
  sent_.reset();
  sent_scene_.reset();
  const TimeSpans& spans = recording_->spans();
  const std::uint64_t position =
      request.after ? spans.PositionOf({request.after->edition, request.after->tick}) : spans.BeginOf(request.from);
  Result<ReplayCursor> cursor = ReplayCursor::At(*recording_, recording_->KeyframeUpTo(position));
  if (!cursor.ok()) return Broken(cursor.error().message);
  cursor_.emplace(std::move(cursor).value());
  Result<const RecordedTick*> next = Next();
  if (next.ok() && next.value() == nullptr) return Broken("it has no state");
  while (next.ok() && next.value() != nullptr && (!cursor_->has_state() || cursor_->position() < position)) {
    if (Status broken = Advance(); !broken.ok()) return broken;
    next = Next();
  }
  if (!next.ok()) return next.error();
  if (!request.after || next.value() == nullptr) return {};
  // The memory may have this state already.
  const bool knows = request.after->decided || !next.value()->is_step();
  sent_scene_ = cursor_->world().scene();
  return knows ? Advance() : Status();
}

Status JournalHistory::Add(std::vector<HistoryEntry>& entries) {
  HistoryEntry& entry = entries.emplace_back();
  const ReplayedWorld& world = cursor_->world();
  const RecordedTick& next = *cursor_->Next().value();
  entry.frame = world.Frame();
  entry.step_follows = next.is_step();
  if (entry.step_follows) entry.frame.commands = next.commands;
  if (world.scene() != sent_scene_) entry.world = WorldToSend();
  sent_scene_ = world.scene();
  sent_ = {entry.frame.edition, entry.frame.state.tick, entry.step_follows};
  return Advance();
}

Result<std::vector<HistoryEntry>> JournalHistory::ReadBatch(const HistoryRequest& request) {
  std::vector<HistoryEntry> entries;
  if (!IsAt(request)) {
    if (Status broken = Seek(request); !broken.ok()) return broken.error();
  }
  std::size_t bytes = 0;
  while (entries.size() < kMaxEntries && bytes < kMaxBytes) {
    const Result<const RecordedTick*> next = Next();
    if (!next.ok()) return next.error();
    if (next.value() == nullptr) break;
    bytes += MemoryOf(cursor_->world().state());
    if (Status broken = Add(entries); !broken.ok()) return broken.error();
  }
  return entries;
}

Result<std::vector<HistoryEntry>> JournalHistory::Read(const HistoryRequest& request) {
  if (recording_ != nullptr) {
    Result<std::vector<HistoryEntry>> entries = ReadBatch(request);
    if (!entries.ok() || !entries.value().empty()) return entries;
  }
  // The file has grown since.
  if (Status broken = Open(); !broken.ok()) return broken.error();
  Result<std::vector<HistoryEntry>> entries = ReadBatch(request);
  if (entries.ok() && entries.value().empty()) return Broken("a state is missing");
  return entries;
}

Result<std::unique_ptr<RewindStates>> JournalHistory::StartRewind(const control::Rewind& request,
                                                                  const FrameMessage& newest) {
  Result<std::unique_ptr<JournalRewind>> rewind = JournalRewind::Start(recordings_, request, newest);
  if (!rewind.ok()) return rewind.error();
  return std::unique_ptr<RewindStates>(std::move(rewind).value());
}

Result<std::unique_ptr<JournalRewind>> JournalRewind::Start(const std::vector<RunRecorder*>& recordings,
                                                            const control::Rewind& request,
                                                            const FrameMessage& newest) {
  std::unique_ptr<JournalRewind> rewind(new JournalRewind(recordings));
  if (Status failure = rewind->Open(); !failure.ok()) return failure.error();
  const Recording& recording = *rewind->recording_;
  const std::optional<std::uint64_t> last = recording.spans().Last(request.tick);
  if (!last) return Error{{}, fmt::format("the recording of the run has no tick {}", request.tick)};
  rewind->request_ = request;
  rewind->newest_ = newest;
  rewind->newest_.events.clear();
  rewind->last_ = *last;
  rewind->shifted_ = newest.edition + 1;
  if (Status failure = rewind->PlaceCursor(recording.KeyframeUpTo(*last)); !failure.ok()) return failure.error();
  return rewind;
}

Result<std::unique_ptr<JournalRewind>> JournalRewind::Finish(const std::vector<RunRecorder*>& recordings,
                                                             const UnfinishedRewind& unfinished,
                                                             const FrameMessage& newest, std::uint64_t next_number) {
  std::unique_ptr<JournalRewind> rewind(new JournalRewind(recordings));
  if (Status failure = rewind->Open(); !failure.ok()) return failure.error();
  rewind->newest_ = newest;
  rewind->shifted_ = newest.fresh_edition;
  rewind->copies_ = unfinished.copies;
  rewind->written_ = next_number - unfinished.number - 1;
  if (Status failure = rewind->StartSeeking(unfinished.copied_from); !failure.ok()) return failure.error();
  return rewind;
}

Error JournalRewind::Broken(const std::string& problem) const {
  return BrokenRecording(recordings_, problem);
}

Status JournalRewind::Open() {
  Result<std::unique_ptr<const Recording>> recording = OpenRecordingOf(recordings_);
  if (!recording.ok()) return recording.error();
  recording_ = std::move(recording).value();
  return {};
}

Status JournalRewind::PlaceCursor(std::size_t chunk) {
  Result<ReplayCursor> cursor = ReplayCursor::At(*recording_, chunk);
  if (!cursor.ok()) return Broken(cursor.error().message);
  cursor_.emplace(std::move(cursor).value());
  return {};
}

Status JournalRewind::Advance() {
  const Result<const RecordedTick*> next = cursor_->Next();
  if (!next.ok()) return Broken(next.error().message);
  if (next.value() == nullptr) return Broken("a state of the rewind is missing");
  const Status problem = cursor_->Advance();
  return problem.ok() ? problem : Broken(problem.error().message);
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
      failure = Make();
      break;
    case Stage::kMade:
      break;
  }
  if (!failure.ok()) return failure.error();
  return stage_ != Stage::kMade;
}

Status JournalRewind::Find() {
  if (!cursor_->has_state() || cursor_->position() < last_) return Advance();
  if (cursor_->tick().tick != request_.tick) return Broken(fmt::format("tick {} is missing", request_.tick));
  return StartSeeking(cursor_->world().fresh_edition());
}

Status JournalRewind::StartSeeking(Edition edition) {
  stage_ = Stage::kSeeking;
  // Robots of the tick begin at this edition; their memory needs all states from there on.
  first_edition_ = edition;
  // The edit that made the robots is stepped, too.
  const std::uint64_t first = recording_->spans().BeginOf(edition);
  if (first > 0) first_chunk_ = recording_->KeyframeUpTo(first - 1);
  return PlaceCursor(first_chunk_);
}

Status JournalRewind::Seek() {
  if (Status broken = Advance(); !broken.ok()) return broken;
  if (cursor_->world().edition() < first_edition_) return {};
  first_ = cursor_->position();
  if (copies_) {
    last_ = first_ + *copies_;
  } else {
    first_tick_ = FirstTick();
  }
  stage_ = first_ == last_ ? Stage::kMade : Stage::kMaking;
  return {};
}

Status JournalRewind::Make() {
  const ControllerCheckpoint at{Shift(cursor_->world().edition()), cursor_->world().state().tick, false};
  if (Status broken = Advance(); !broken.ok()) return broken;
  previous_ = at;
  previous_->decided = cursor_->tick().is_step();
  if (cursor_->position() == last_) stage_ = Stage::kMade;
  return {};
}

Result<RewoundRun> JournalRewind::Write() {
  for (RunRecorder* const recording : recordings_) {
    if (Status failure = WriteTo(*recording); !failure.ok()) return failure.error();
  }
  return RewoundRun{cursor_->world().scene(), cursor_->world().original(), CopiedFrame(), previous_};
}

Status JournalRewind::WriteTo(RunRecorder& recording) const {
  TickReader reader(*recording_, first_chunk_);
  bool has_begun = !first_tick_;
  std::uint64_t newest = first_ + written_;
  return recording.AppendRewind([&](RecordedTick& tick) -> Result<bool> {
    if (!std::exchange(has_begun, true)) {
      tick = *first_tick_;
      return true;
    }
    if (newest == last_) return false;
    do {
      const Result<bool> more = reader.Next(tick);
      if (!more.ok() || !more.value()) return Broken(more.ok() ? "a state is missing" : more.error().message);
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
  FrameMessage frame = cursor_->world().Frame();
  Shift(frame);
  return frame;
}

RecordedTick JournalRewind::FirstTick() const {
  const ReplayedWorld& world = cursor_->world();
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

}  // namespace troupe
