#include "world-service/replay/run_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "common/sensing/sensor_suite.h"

namespace troupe {
namespace {

constexpr std::uint64_t kTicksPerReport = 64;

bool IsSame(const Event& a, const Event& b) {
  return a.type == b.type && a.robot == b.robot && a.other == b.other && a.object == b.object && a.detail == b.detail;
}

}  // namespace

Result<ScanWriter> ScanWriter::Create(const std::string& path) {
  Result<OutputFile> file = OutputFile::Create(path);
  if (!file.ok()) return file.error();
  return ScanWriter(std::move(file).value());
}

Status ScanWriter::Write(const ReplayedWorld& world) {
  const WorldDescription& description = world.world();
  if (world.scene() != scene_) {
    scene_ = world.scene();
    sensors_.clear();
    for (std::size_t i = 0; i < description.robots.size(); ++i) {
      if (!RobotExists(description, RobotId(i))) continue;
      for (auto& sensor : MakeSensors(*scene_, RobotId(i))) sensors_.push_back(std::move(sensor));
    }
  }
  const Tick tick = world.state().tick;
  for (const auto& sensor : sensors_) {
    if (!sensor->IsDueAt(tick)) continue;
    if (fresh_edition_ != world.fresh_edition()) {
      fresh_edition_ = world.fresh_edition();
      file_.Append("{\"edition\":" + std::to_string(fresh_edition_) + "}");
      if (Status failure = file_.EndLine(); !failure.ok()) return failure;
    }
    std::string lines =
        sensor->JsonLines(description, sensor->Measure({*scene_, world.bodies(), &world.state()}, tick));
    if (lines.empty()) continue;
    lines.pop_back();  // the last line end
    file_.Append(lines);
    if (Status failure = file_.EndLine(); !failure.ok()) return failure;
  }
  return {};
}

Result<ReplayReport> RunReplay::Run() {
  if (Status problem = FindRange(); !problem.ok()) return problem.error();
  if (Status problem = CreateOutputs(); !problem.ok()) return problem.error();
  const Status replayed = RunTicks();
  const Status closed = CloseOutputs();
  for (const Status& outcome : {replayed, closed}) {
    if (!outcome.ok()) return outcome.error();
  }
  return report_;
}

Status RunReplay::FindRange() {
  const TimeSpans& spans = recording_.spans();
  to_ = Recording::kEnd;
  for (const auto& [tick, position, place] :
       {std::tuple(options_.from, &from_, &TimeSpans::First), std::tuple(options_.to, &to_, &TimeSpans::Last)}) {
    if (!tick) continue;
    const std::optional<std::uint64_t> found = (spans.*place)(*tick);
    if (!found) return NoSuchTick(recording_, *tick);
    *position = *found;
  }
  if (from_ <= to_) return {};
  return Error{{recording_.name()},
               fmt::format("found the range from tick {} to {}, expected one that does not end before it begins",
                           options_.from.value_or(0), *options_.to)};
}

Status RunReplay::CreateOutputs() {
  const OutputFiles& files = options_.outputs;
  if (!files.hash_log.empty() || !files.poses.empty()) {
    if (Status failure = CreateRecorder(files); !failure.ok()) return failure;
  }
  if (options_.scans.empty()) return {};
  Result<ScanWriter> scans = ScanWriter::Create(options_.scans);
  if (!scans.ok()) return scans.error();
  scans_.emplace(std::move(scans).value());
  return {};
}

Status RunReplay::CreateRecorder(const OutputFiles& files) {
  Result<std::unique_ptr<Recorder>> recorder = Recorder::Create(recording_.run().world, files);
  if (!recorder.ok()) return recorder.error();
  recorder_ = std::move(recorder).value();
  return {};
}

Status RunReplay::CloseOutputs() {
  const Status recorded = recorder_ != nullptr ? recorder_->OnEnd() : Status();
  const Status scanned = scans_ ? scans_->Close() : Status();
  return recorded.ok() ? scanned : recorded;
}

Status RunReplay::RunTicks() {
  constexpr const char* kMisplaced = "the ticks are not those that their times say";
  const std::size_t chunk = options_.check ? 0 : recording_.KeyframeUpTo(from_);  // a check needs all states
  Result<ReplayCursor> cursor = ReplayCursor::At(recording_, chunk);
  if (!cursor.ok()) return Damaged(cursor.error().message);
  cursor_.emplace(std::move(cursor).value());
  if (chunk == 0) recorded_scene_ = cursor_->world().scene();
  for (;;) {
    const Result<const RecordedTick*> read = cursor_->Next();
    if (!read.ok()) return Damaged(read.error().message);
    if (read.value() == nullptr) break;
    const RecordedTick& next = *read.value();
    // The agents measured a state when they answered it, which a step follows.
    const bool is_measured = scans_ && report_.states > 0 && next.is_step() && !cursor_->world().in_rewind();
    if (is_measured) {
      if (Status failure = scans_->Write(cursor_->world()); !failure.ok()) return failure;
    }
    if (next.number > to_) return {};
    const Result<bool> same = Advance();
    if (!same.ok()) return same.error();
    if (!same.value()) return {};
    if (IsMisplaced()) return Damaged(kMisplaced);
    if (IsInRange(cursor_->position())) {
      if (Status failure = AddState(); !failure.ok()) return failure;
    }
    ReportProgress(cursor_->tick());
  }
  const bool ends_early = options_.to && (!cursor_->has_state() || cursor_->position() != to_);
  if (recording_.damage()) return Damaged(recording_.damage()->problem);
  return report_.states == 0 || ends_early ? Damaged(kMisplaced) : Status();
}

bool RunReplay::IsMisplaced() const {
  const RecordedTick& tick = cursor_->tick();
  return (options_.from && tick.number == from_ && tick.tick != *options_.from) ||
         (options_.to && tick.number == to_ && tick.tick != *options_.to);
}

Result<bool> RunReplay::Advance() {
  const RecordedTick& next = *cursor_->Next().value();
  if (options_.check) {
    const Result<std::optional<std::string>> difference = options_.check(cursor_->world(), next);
    if (!difference.ok()) return difference.error();
    report_.difference = difference.value();
    if (report_.difference) return false;
  }
  if (const Status failure = cursor_->Advance(); !failure.ok()) {
    const bool is_damage = cursor_->fault() == ReplayCursor::Fault::kDamage;
    (is_damage ? report_.damage : report_.difference) = failure.error().message;
    FindModel();
    return false;
  }
  if (options_.compare_events && !HasEqualEvents()) {
    report_.difference = fmt::format("tick {}: found {} events, expected {}, or others", cursor_->tick().tick,
                                     cursor_->world().events().size(), StepEventsOf(cursor_->tick().events).size());
    return false;
  }
  return true;
}

bool RunReplay::HasEqualEvents() const {
  const std::vector<Event> recorded = StepEventsOf(cursor_->tick().events);
  const std::vector<Event>& found = cursor_->world().events();
  return std::equal(found.begin(), found.end(), recorded.begin(), recorded.end(), IsSame);
}

void RunReplay::FindModel() {
  if (cursor_->fault() != ReplayCursor::Fault::kDifference) return;
  const auto add = [this](Tick tick, const std::string& found) {
    *report_.difference += fmt::format("; at the next recorded state, of tick {}, {}", tick,
                                       found.empty() ? "no model differs any more" : found);
  };
  for (;;) {
    const Result<const RecordedTick*> next = cursor_->Next();
    if (!next.ok() || next.value() == nullptr) break;
    if (const std::optional<RecordedEdit>& edit = next.value()->edit) {
      return add(edit->before.state.tick, cursor_->DifferenceFrom(edit->before));
    }
    if (!cursor_->Apply().ok()) break;
    const RecordedTick& tick = cursor_->tick();
    if (tick.keyframe) return add(tick.tick, cursor_->DifferenceFrom(*tick.keyframe));
  }
  *report_.difference += "; no recorded state follows that could name the model";
}

Status RunReplay::AddState() {
  const RecordedTick& tick = cursor_->tick();
  if (report_.states++ == 0) {
    report_.first = tick.tick;
    if (scans_) scans_->Begin(cursor_->world().fresh_edition());
  }
  report_.last = tick.tick;
  report_.state_hash = cursor_->world().state_hash();
  if (cursor_->world().in_rewind()) return {};
  if (Status failure = WriteOutputs(); !failure.ok()) return failure;
  return options_.on_state ? options_.on_state(cursor_->world(), tick) : Status();
}

Status RunReplay::WriteOutputs() {
  const ReplayedWorld& world = cursor_->world();
  if (recorder_ == nullptr) return {};
  const RecordedTick& tick = cursor_->tick();
  if (world.scene() != recorded_scene_) {
    recorded_scene_ = world.scene();
    recorder_->OnWorldChange(recorded_scene_, tick.edition);
  }
  frame_.state = world.state();
  frame_.state_hash = world.state_hash();
  frame_.edition = tick.edition;
  return recorder_->OnTick({frame_, tick.proposals});
}

void RunReplay::ReportProgress(const RecordedTick& tick) {
  if (!options_.on_progress || tick.number % kTicksPerReport != 0) return;
  const double end = static_cast<double>(std::min(to_, recording_.spans().last()));
  options_.on_progress(tick.tick, end > 0.0 ? std::min(1.0, static_cast<double>(tick.number) / end) : 1.0);
}

}  // namespace troupe
