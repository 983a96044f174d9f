#include "world-service/replay/journal_history.h"

#include <map>
#include <utility>

#include "world-service/replay/journal_rewind.h"
#include "world-service/service/apply_edit.h"

namespace troupe {
namespace {

// The entries of one batch: a message that any receiver can process, for which an agent works some ms.
constexpr std::size_t kMaxEntries = 500;
constexpr std::size_t kMaxBytes = std::size_t{256} << 10;  // estimated

class JournalHistory final : public RunHistory {
 public:
  explicit JournalHistory(const std::vector<RunRecorder*>& recorders) : past_(recorders) {}

  Result<std::vector<HistoryEntry>> Read(const HistoryRequest& request) override;
  Result<std::unique_ptr<RewindStates>> StartRewind(const control::Rewind& request,
                                                    const FrameMessage& newest) override;

 private:
  Status Open();
  // Goes to the state before the first entry of the answer, or to that entry.
  Status Seek(const HistoryRequest& request);
  bool IsAt(const HistoryRequest& request) const { return request.after && request.after == sent_; }
  // Appends the state, with the tick that follows, and goes to the next.
  Status Add(std::vector<HistoryEntry>& entries, const RecordedTick& next);
  Result<std::vector<HistoryEntry>> ReadBatch(const HistoryRequest& request);
  // The world of the state; robots that are rebuilt later need no controller.
  WorldDescription WorldToSend() const;
  Status FindChanges();

  OwnRecording past_;
  std::map<std::string, Edition> changed_;    // by robot: when it got another controller, and was rebuilt
  std::optional<ControllerCheckpoint> sent_;  // the entry before the state; nothing: not sent
  std::shared_ptr<const Scene> sent_scene_;
};

Status JournalHistory::Open() {
  sent_.reset();
  const Status opened = past_.Open();
  return opened.ok() ? FindChanges() : opened;
}

Status JournalHistory::FindChanges() {
  changed_.clear();
  const Status visited =
      past_.recording().VisitEdits(past_.recording().chunks(), [this](std::uint64_t, const RecordedEdit& edit) {
        const auto* const change = std::get_if<control::Change>(&edit.request);
        if (change == nullptr) return Status();
        const Result<WorldChanges> changes = WorldChanges::FromText(change->changes);
        if (!changes.ok()) return Status(changes.error());
        for (const auto& [robot, controller] : changes.value().controllers) changed_[robot] = edit.before.edition + 1;
        return Status();
      });
  return visited.ok() ? visited : Status(past_.Broken(visited.error().message));
}

WorldDescription JournalHistory::WorldToSend() const {
  WorldDescription world = past_.world().world();
  for (RobotDescription& robot : world.robots) {
    // A branch has changed the controller later: in the states before, the robot's controller was another one, whose
    // memory is dropped at the change. So the agent need not have that controller's library at all.
    const auto changed = changed_.find(robot.name);
    if (changed != changed_.end() && past_.world().edition() < changed->second) robot.controller = {};
  }
  return world;
}

Status JournalHistory::Seek(const HistoryRequest& request) {
  sent_.reset();
  sent_scene_.reset();
  const TimeSpans& spans = past_.recording().spans();
  const std::uint64_t position =
      request.after ? spans.PositionOf({request.after->edition, request.after->tick}) : spans.BeginOf(request.from);
  if (Status broken = past_.Approach(position); !broken.ok()) return broken;
  Result<const RecordedTick*> next = past_.Next();
  while (next.ok() && next.value() != nullptr &&
         (!past_.cursor().has_state() || past_.cursor().position() < position)) {
    if (Status broken = past_.Advance(); !broken.ok()) return broken;
    next = past_.Next();
  }
  if (!next.ok()) return next.error();
  if (!past_.cursor().has_state()) return past_.Broken("it has no state");
  if (!request.after || next.value() == nullptr) return {};
  // The memory may have this state already.
  const bool knows = request.after->decided || !next.value()->is_step();
  sent_scene_ = past_.world().scene();
  return knows ? past_.Advance() : Status();
}

Status JournalHistory::Add(std::vector<HistoryEntry>& entries, const RecordedTick& next) {
  HistoryEntry& entry = entries.emplace_back();
  const ReplayedWorld& world = past_.world();
  entry.frame = world.Frame();
  entry.step_follows = next.is_step();
  if (entry.step_follows) entry.frame.commands = next.commands;
  if (world.scene() != sent_scene_) entry.world = WorldToSend();
  sent_scene_ = world.scene();
  sent_ = {entry.frame.edition, entry.frame.state.tick, entry.step_follows};
  return past_.Advance();
}

Result<std::vector<HistoryEntry>> JournalHistory::ReadBatch(const HistoryRequest& request) {
  std::vector<HistoryEntry> entries;
  if (!IsAt(request)) {
    if (Status broken = Seek(request); !broken.ok()) return broken.error();
  }
  std::size_t bytes = 0;
  while (entries.size() < kMaxEntries && bytes < kMaxBytes) {
    const Result<const RecordedTick*> next = past_.Next();
    if (!next.ok()) return next.error();
    if (next.value() == nullptr) break;
    bytes += MemoryOf(past_.world().state());
    if (Status broken = Add(entries, *next.value()); !broken.ok()) return broken.error();
  }
  return entries;
}

Result<std::vector<HistoryEntry>> JournalHistory::Read(const HistoryRequest& request) {
  if (past_.is_open()) {
    Result<std::vector<HistoryEntry>> entries = ReadBatch(request);
    if (!entries.ok() || !entries.value().empty()) return entries;
  }
  // The file has grown since.
  if (Status broken = Open(); !broken.ok()) return broken.error();
  Result<std::vector<HistoryEntry>> entries = ReadBatch(request);
  if (entries.ok() && entries.value().empty()) return past_.Broken("a state is missing");
  return entries;
}

Result<std::unique_ptr<RewindStates>> JournalHistory::StartRewind(const control::Rewind& request,
                                                                  const FrameMessage& newest) {
  return troupe::StartRewind(past_.recorders(), request, newest);
}

}  // namespace

std::unique_ptr<RunHistory> MakeRunHistory(const std::vector<RunRecorder*>& recorders) {
  if (recorders.empty()) return nullptr;
  return std::make_unique<JournalHistory>(recorders);
}

Error OwnRecording::Broken(const std::string& problem) const {
  return {{recorders_.back()->path()}, "the recording of this run cannot be read: " + problem, ErrorCode::kFailure};
}

Status OwnRecording::Open() {
  cursor_.reset();
  recording_.reset();
  if (Status flushed = recorders_.back()->Flush(); !flushed.ok()) return flushed;
  Result<Recording> recording = Recording::Open(recorders_.back()->path());
  if (!recording.ok()) return Broken(recording.error().message);
  recording_ = std::make_unique<const Recording>(std::move(recording).value());
  cursor_.emplace(*recording_);
  return {};
}

Result<const RecordedTick*> OwnRecording::Next() {
  Result<const RecordedTick*> next = cursor_->Next();
  return next.ok() ? next : Broken(next.error().message);
}

Status OwnRecording::Advance() {
  const Result<bool> more = cursor_->Step();
  if (more.ok() && more.value()) return {};
  return Broken(more.ok() ? "a state is missing" : more.error().message);
}

}  // namespace troupe
