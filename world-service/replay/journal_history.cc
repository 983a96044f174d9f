#include "world-service/replay/journal_history.h"

#include <limits>
#include <utility>

#include "world-service/replay/journal_rewind.h"
#include "world-service/service/apply_edit.h"

namespace troupe {
namespace {

// Of one batch: a message of a size that no receiver has trouble with, for which an agent works some ms.
constexpr std::size_t kMostEntries = 500;
constexpr std::size_t kMostBytes = std::size_t{256} << 10;  // estimated

}  // namespace

std::unique_ptr<RunHistory> MakeRunHistory(const std::vector<RunRecorder*>& recordings) {
  if (recordings.empty()) return nullptr;
  return std::make_unique<JournalHistory>(recordings);
}

Error JournalHistory::Broken(const std::string& problem) const {
  return {{recordings_.back()->path()}, "the recording of this run cannot be read: " + problem, ErrorCode::kFailure};
}

Status JournalHistory::Open() {
  cursor_.reset();
  recording_.reset();
  if (Status flushed = recordings_.back()->Flush(); !flushed.ok()) return flushed;
  Result<Recording> recording = Recording::Open(recordings_.back()->path());
  if (!recording.ok()) return Broken(recording.error().message);
  recording_ = std::make_unique<const Recording>(std::move(recording).value());
  return FindChanges();
}

Status JournalHistory::FindChanges() {
  changed_.clear();
  const Status visited = recording_->VisitEdits(recording_->chunks(), [this](std::uint64_t, const RecordedEdit& edit) {
    if (edit.request.command != ControlCommand::kChange) return Status();
    const Result<WorldChanges> changes = WorldChanges::FromText(edit.request.source);
    if (!changes.ok()) return Status(changes.error());
    for (const auto& [robot, controller] : changes.value().controllers) changed_[robot] = edit.before.edition + 1;
    return Status();
  });
  return visited.ok() ? visited : Status(Broken(visited.error().message));
}

WorldDescription JournalHistory::WorldToSend() const {
  WorldDescription world = cursor_->world().world();
  for (RobotDescription& robot : world.robots) {
    const auto changed = changed_.find(robot.name);
    if (changed != changed_.end() && cursor_->world().edition() < changed->second) robot.controller = {};
  }
  return world;
}

Status JournalHistory::Advance() {
  const Status problem = cursor_->Advance();
  return problem.ok() ? problem : Broken(problem.error().message);
}

Status JournalHistory::Seek(const HistoryRequest& request) {
  sent_.reset();
  sent_scene_.reset();
  const Edition edition = request.after ? request.after->edition : request.from;
  std::size_t chunk = 0;
  if (request.after) {
    chunk = recording_->KeyframeUpTo(edition, request.after->tick);
  } else if (edition > 0) {
    chunk = recording_->KeyframeUpTo(edition - 1, std::numeric_limits<Tick>::max());
  }
  Result<ReplayCursor> cursor = ReplayCursor::At(*recording_, chunk);
  if (!cursor.ok()) return Broken(cursor.error().message);
  cursor_.emplace(std::move(cursor).value());
  if (!cursor_->next()) return Broken("it has no state");
  const ReplayedWorld& world = cursor_->world();
  const auto is_before = [&] {
    if (!request.after) return world.edition() < edition;
    return std::pair(world.edition(), world.state().tick) < std::pair(edition, request.after->tick);
  };
  do {
    if (Status broken = Advance(); !broken.ok()) return broken;
  } while (cursor_->next() && is_before());
  if (!request.after || !cursor_->next()) return {};
  // The memory may have this state already.
  const bool knows = request.after->decided || !cursor_->next()->is_step();
  sent_scene_ = world.scene();
  return knows ? Advance() : Status();
}

Status JournalHistory::Add(std::vector<HistoryEntry>& entries) {
  HistoryEntry& entry = entries.emplace_back();
  const ReplayedWorld& world = cursor_->world();
  entry.frame = world.Frame();
  entry.step_follows = cursor_->next()->is_step();
  if (entry.step_follows) entry.frame.commands = cursor_->next()->commands;
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
  while (cursor_->next() && entries.size() < kMostEntries && bytes < kMostBytes) {
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

Result<std::unique_ptr<RewindStates>> JournalHistory::StartRewind(const ControlRequest& request,
                                                                  const FrameMessage& newest) {
  Result<std::unique_ptr<JournalRewind>> rewind = JournalRewind::Start(recordings_, request, newest);
  if (!rewind.ok()) return rewind.error();
  return std::unique_ptr<RewindStates>(std::move(rewind).value());
}

}  // namespace troupe
