#include "world-service/replay/journal_history.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "world-service/service/world_changes.h"

namespace troupe {
namespace {

// Of one batch: a message of a size that no receiver has trouble with, for which an agent works some ms.
constexpr std::size_t kMostEntries = 500;
constexpr std::size_t kMostBytes = std::size_t{256} << 10;  // estimated

}  // namespace

Error JournalHistory::Broken(const std::string& problem) const {
  return {{path_}, "the recording of this run cannot be read: " + problem, ErrorCode::kFailure};
}

Status JournalHistory::Open() {
  world_.reset();
  reader_.reset();
  recording_.reset();
  if (Status flushed = flush_(); !flushed.ok()) return flushed;
  Result<Recording> recording = Recording::Open(path_);
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
  WorldDescription world = world_->world();
  for (RobotDescription& robot : world.robots) {
    const auto changed = changed_.find(robot.name);
    if (changed != changed_.end() && world_->edition() < changed->second) robot.controller = {};
  }
  return world;
}

Status JournalHistory::ReadNext() {
  RecordedTick tick;
  const Result<bool> more = reader_->Next(tick);
  if (!more.ok()) return Broken(more.error().message);
  next_.reset();
  if (more.value()) next_ = std::move(tick);
  return {};
}

Status JournalHistory::ApplyNext() {
  if (Status problem = world_->Follow(*next_); !problem.ok()) {
    return Broken(fmt::format("tick {}: {}", next_->tick, problem.error().message));
  }
  return ReadNext();
}

Status JournalHistory::Seek(const HistoryRequest& request) {
  sent_.reset();
  sent_scene_.reset();
  const Edition edition = request.after ? request.after->edition : request.from;
  std::size_t chunk = 0;
  if (request.after) {
    chunk = recording_->KeyframeUpTo(edition, request.after->tick);
  } else if (edition > 0) {
    chunk = recording_->KeyframeUpTo(edition - 1, static_cast<Tick>(-1));
  }
  Result<ReplayedWorld> world = ReplayedWorld::At(*recording_, chunk);
  if (!world.ok()) return Broken(world.error().message);
  world_.emplace(std::move(world).value());
  reader_.emplace(*recording_, chunk);
  if (Status broken = ReadNext(); !broken.ok()) return broken;
  if (!next_) return Broken("it has no state");
  if (Status broken = ApplyNext(); !broken.ok()) return broken;  // the first is the state itself
  const auto is_before = [&] {
    if (!request.after) return world_->edition() < edition;
    return std::pair(world_->edition(), world_->state().tick) < std::pair(edition, request.after->tick);
  };
  while (next_ && is_before()) {
    if (Status broken = ApplyNext(); !broken.ok()) return broken;
  }
  if (!request.after || !next_) return {};
  // The memory may have this state already.
  const bool knows = request.after->decided || !next_->is_step();
  sent_scene_ = world_->scene();
  return knows ? ApplyNext() : Status();
}

Status JournalHistory::Add(std::vector<HistoryEntry>& entries) {
  HistoryEntry& entry = entries.emplace_back();
  entry.frame = world_->Frame();
  entry.step_follows = next_->is_step();
  if (entry.step_follows) entry.frame.commands = next_->commands;
  if (world_->scene() != sent_scene_) entry.world = WorldToSend();
  sent_scene_ = world_->scene();
  sent_ = {entry.frame.edition, entry.frame.state.tick, entry.step_follows};
  return ApplyNext();
}

Result<std::vector<HistoryEntry>> JournalHistory::ReadBatch(const HistoryRequest& request) {
  std::vector<HistoryEntry> entries;
  if (!IsAt(request)) {
    if (Status broken = Seek(request); !broken.ok()) return broken.error();
  }
  std::size_t bytes = 0;
  while (next_ && entries.size() < kMostEntries && bytes < kMostBytes) {
    bytes += MemoryOf(world_->state());
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

std::unique_ptr<JournalHistory> MakeRunHistory(RunRecorder* recording, const std::string& path) {
  if (recording == nullptr) return nullptr;
  return std::make_unique<JournalHistory>(
      path, [recording] { return recording->Flush(); },
      [recording](RecordedTick tick) { return recording->Append(std::move(tick)); });
}

Result<RewoundRun> JournalHistory::Rewind(const ControlRequest& request, const FrameMessage& newest) {
  if (Status broken = Open(); !broken.ok()) return broken.error();
  const Result<Past> past = FindLast(request.ticks);
  if (!past.ok()) return past.error();
  if (Status broken = Seek({{}, past.value().fresh_edition}); !broken.ok()) return broken.error();
  Way way{newest.run, world_->edition(), newest.edition + 1};
  if (next_ && next_->number <= past.value().number) way.copies = past.value().number - next_->number + 1;
  if (Status failure = AppendBegin(request, newest, way); !failure.ok()) return failure.error();
  return GoWay(way, 0);
}

Result<RewoundRun> JournalHistory::FinishRewind(const UnfinishedRewind& rewind, const FrameMessage& newest,
                                                std::uint64_t next_number) {
  if (Status broken = Open(); !broken.ok()) return broken.error();
  if (Status broken = Seek({{}, rewind.copied_from}); !broken.ok()) return broken.error();
  return GoWay({newest.run, rewind.copied_from, newest.fresh_edition, rewind.copies}, next_number - rewind.number - 1);
}

Result<JournalHistory::Past> JournalHistory::FindLast(Tick tick) const {
  const std::optional<std::uint64_t> time = recording_->places().Last(tick);
  if (!time) return Error{{}, fmt::format("the recording of the run has no tick {}", tick)};
  const std::size_t chunk = recording_->KeyframeBefore(*time).value_or(0);
  Result<ReplayedWorld> world = ReplayedWorld::At(*recording_, chunk);
  if (!world.ok()) return Broken(world.error().message);
  TickReader reader(*recording_, chunk);
  RecordedTick next;
  std::optional<Past> found;
  for (;;) {
    const Result<bool> more = reader.Next(next);
    if (!more.ok()) return Broken(more.error().message);
    if (!more.value() || next.log_time > *time) break;
    if (Status problem = world.value().Follow(next); !problem.ok()) return Broken(problem.error().message);
    if (next.tick == tick) found = {next.number, world.value().fresh_edition()};
  }
  if (!found) return Broken(fmt::format("tick {} is missing", tick));
  return *found;
}

FrameMessage JournalHistory::CopiedFrame(const Way& way) const {
  FrameMessage frame = world_->Frame();
  frame.run = way.run;
  frame.edition = way.Shift(frame.edition);
  frame.world_edition = way.Shift(frame.world_edition);
  frame.fresh_edition = way.shifted;
  return frame;
}

Status JournalHistory::AppendBegin(const ControlRequest& request, const FrameMessage& newest, const Way& way) {
  const FrameMessage frame = CopiedFrame(way);
  RecordedTick tick;
  tick.tick = frame.state.tick;
  tick.edition = frame.edition;
  tick.state_hash = frame.state_hash;
  RecordedEdit& edit = tick.edit.emplace();
  edit.before = newest;
  edit.before.events.clear();
  edit.request = request;
  edit.world = world_->world();
  if (world_->original() != world_->scene()) edit.original = world_->original()->world();
  edit.restored = frame;
  edit.copies = way.copies;
  edit.copied_from = way.begin;
  return append_(std::move(tick));
}

Result<RewoundRun> JournalHistory::GoWay(const Way& way, std::uint64_t made) {
  RewoundRun rewound;
  for (std::uint64_t i = 0; i < way.copies; ++i) {
    if (!next_) return Broken("a state on the way of a rewind is missing");
    rewound.previous = {way.Shift(world_->edition()), world_->state().tick, next_->is_step()};
    RecordedTick tick = *next_;
    if (Status broken = ApplyNext(); !broken.ok()) return broken.error();
    if (i < made) continue;
    if (Status failure = AppendCopy(way, std::move(tick)); !failure.ok()) return failure.error();
  }
  rewound.frame = CopiedFrame(way);
  rewound.scene = world_->scene();
  rewound.original = world_->original();
  world_.reset();  // its editions are those of the past
  return rewound;
}

Status JournalHistory::AppendCopy(const Way& way, RecordedTick copy) {
  copy.edition = way.Shift(copy.edition);
  copy.keyframe.reset();
  if (copy.edit) {
    FrameMessage& before = copy.edit->before;
    for (Edition* edition : {&before.edition, &before.world_edition, &before.fresh_edition}) {
      *edition = way.Shift(*edition);
    }
    before.run = way.run;
  } else {
    copy.keyframe = CopiedFrame(way);
  }
  return append_(std::move(copy));
}

}  // namespace troupe
