#include "world-service/replay/run_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/sensing/sensor_suite.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

constexpr std::uint64_t kTicksPerReport = 64;

// Events of the run, which a replay does not repeat, as those of agents.
bool IsOfStep(const Event& event) {
  return event.type != EventType::kJoined && event.type != EventType::kLeft &&
         event.type != EventType::kProposalRejected && event.type != EventType::kReported;
}

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

Status CheckStepVersion(const Recording& recording) {
  const RecordedRun& run = recording.run();
  if (run.step_version == kStepVersion) return {};
  return Error{
      {recording.name()},
      fmt::format("found a recording of step version {} (troupe {}), expected {}: this program steps otherwise",
                  run.step_version, run.program_version, kStepVersion)};
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
  const TickPlaces& places = recording_.places();
  const auto missing = [&](Tick tick) {
    return Error{{recording_.name()},
                 fmt::format("found tick {}, expected at most {}, the last of the recording", tick, places.greatest())};
  };
  if (options_.from) {
    const std::optional<std::uint64_t> time = places.First(*options_.from);
    if (!time) return missing(*options_.from);
    from_time_ = *time;
  }
  if (options_.to) {
    to_time_ = places.Last(*options_.to);
    if (!to_time_) return missing(*options_.to);
    if (*to_time_ < from_time_) {
      return Error{{recording_.name()},
                   fmt::format("found the range from tick {} to {}, expected one that does not end "
                               "before it begins",
                               *options_.from, *options_.to)};
    }
  }
  first_chunk_ = options_.from && !options_.check ? recording_.KeyframeBefore(from_time_).value_or(0) : 0;
  return {};
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

Status RunReplay::Start() {
  Result<ReplayedWorld> world = ReplayedWorld::At(recording_, first_chunk_);
  if (!world.ok()) return world.error();
  world_.emplace(std::move(world).value());
  if (first_chunk_ == 0) recorded_scene_ = world_->scene();
  return {};
}

bool RunReplay::IsPastEnd(const RecordedTick& next) const {
  if (!to_time_ || !in_range_) return false;
  const auto is_last = [&](const RecordedTick& tick) {
    return tick.log_time == *to_time_ && tick.tick == *options_.to;
  };
  return is_last(tick_) && !is_last(next);
}

Status RunReplay::RunTicks() {
  if (Status damaged = Start(); !damaged.ok()) {
    report_.damage = damaged.error().message;
    return {};
  }
  TickReader reader(recording_, first_chunk_);
  RecordedTick next;
  for (;;) {
    const Result<bool> more = reader.Next(next);
    if (!more.ok()) report_.damage = more.error().message;
    if (!more.ok() || !more.value()) break;
    // The agents measured a state when they answered it, which a step follows.
    if (in_range_ && next.is_step() && scans_ && !world_->in_rewind()) {
      if (Status failure = scans_->Write(*world_); !failure.ok()) return failure;
    }
    if (IsPastEnd(next)) return {};
    const Result<bool> same = CheckNext(next);
    if (!same.ok()) return same.error();
    if (!same.value()) return {};
    if (!Apply(next)) {
      FindModel(reader);
      return {};
    }
    const bool begins = !in_range_ && (!options_.from || (next.log_time == from_time_ && next.tick == *options_.from));
    if (begins) {
      in_range_ = true;
      report_.first = next.tick;
      if (scans_) scans_->Begin(world_->fresh_edition());
    }
    tick_.log_time = next.log_time;
    tick_.tick = next.tick;
    if (in_range_) {
      ++report_.states;
      report_.last = next.tick;
      report_.state_hash = world_->state_hash();
      if (Status failure = WriteOutputs(next); !failure.ok()) return failure;
    }
    ReportProgress(next);
  }
  if (!report_.damage && recording_.damage()) report_.damage = recording_.damage()->problem;
  const bool ends_early = to_time_ && (tick_.log_time != *to_time_ || tick_.tick != *options_.to);
  if (!report_.damage && (report_.states == 0 || ends_early)) {
    report_.damage = "the ticks are not those that their times say";
  }
  return {};
}

void RunReplay::Differ(const RecordedTick& tick, const std::string& problem) {
  if (!report_.difference) report_.difference = fmt::format("tick {}: {}", tick.tick, problem);
}

Result<bool> RunReplay::CheckNext(const RecordedTick& next) {
  if (!options_.check) return true;
  const Result<std::optional<std::string>> difference = options_.check(*world_, next);
  if (!difference.ok()) return difference.error();
  if (difference.value() && !report_.difference) report_.difference = difference.value();
  return !difference.value();
}

bool RunReplay::Apply(const RecordedTick& tick) {
  if (!std::exchange(has_state_, true) && first_chunk_ > 0) {
    if (const Status restored = world_->Restore(tick); !restored.ok()) {
      report_.damage = fmt::format("tick {}: {}", tick.tick, restored.error().message);
      return false;
    }
  } else {
    if (tick.edit && !CompareState(tick, tick.edit->before)) return false;
    if (Status refused = world_->Apply(tick); !refused.ok()) {
      Differ(tick, refused.error().message);
      names_model_ = true;
      return false;
    }
  }
  return Compare(tick);
}

bool RunReplay::Compare(const RecordedTick& tick) {
  const bool same_hash = world_->state().tick == tick.tick && world_->state_hash() == tick.state_hash;
  if (!same_hash) {
    const std::string model = tick.keyframe ? DescribeDifference(*tick.keyframe) : std::string();
    names_model_ = !model.empty();
    Differ(tick, fmt::format("found the state hash {:016x}, expected {:016x}{}{}", world_->state_hash(),
                             tick.state_hash, names_model_ ? "; " : "", model));
    return false;
  }
  if (tick.keyframe && !CompareState(tick, *tick.keyframe)) return false;
  return !options_.compare_events || CompareEvents(tick);
}

std::string RunReplay::DescribeDifference(const FrameMessage& recorded) const {
  const std::optional<StateDifference> difference = FindDifference(world_->world(), world_->state(), recorded.state);
  if (!difference) return {};
  return fmt::format("the {} of {} is {}, expected {}", difference->field, difference->model, difference->found,
                     difference->expected);
}

bool RunReplay::CompareState(const RecordedTick& tick, const FrameMessage& recorded) {
  const std::string difference = DescribeDifference(recorded);
  if (difference.empty()) return true;
  Differ(tick, difference);
  names_model_ = true;
  return false;
}

bool RunReplay::CompareEvents(const RecordedTick& tick) {
  std::vector<Event> recorded = tick.events;
  std::erase_if(recorded, [](const Event& event) { return !IsOfStep(event); });
  const std::vector<Event>& found = world_->events();
  if (std::equal(found.begin(), found.end(), recorded.begin(), recorded.end(), IsSame)) return true;
  Differ(tick, fmt::format("found {} events, expected {}, or others", found.size(), recorded.size()));
  names_model_ = true;  // the states are equal
  return false;
}

void RunReplay::FindModel(TickReader& reader) {
  if (!report_.difference || names_model_) return;
  const auto add = [this](Tick tick, const std::string& found) {
    *report_.difference += fmt::format("; at the next recorded state, of tick {}, {}", tick,
                                       found.empty() ? "no model differs any more" : found);
  };
  RecordedTick tick;
  for (;;) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok() || !more.value()) break;
    if (tick.edit) return add(tick.edit->before.state.tick, DescribeDifference(tick.edit->before));
    if (!world_->Apply(tick).ok()) break;
    if (tick.keyframe) return add(tick.tick, DescribeDifference(*tick.keyframe));
  }
  *report_.difference += "; no recorded state follows that could name the model";
}

Status RunReplay::WriteOutputs(const RecordedTick& tick) {
  if (recorder_ == nullptr || world_->in_rewind()) return {};
  if (world_->scene() != recorded_scene_) {
    recorded_scene_ = world_->scene();
    recorder_->OnWorldChange(recorded_scene_, tick.edition);
  }
  frame_.state = world_->state();
  frame_.state_hash = world_->state_hash();
  frame_.edition = tick.edition;
  return recorder_->OnTick({frame_, tick.proposals});
}

void RunReplay::ReportProgress(const RecordedTick& tick) {
  if (!options_.on_progress || tick.number % kTicksPerReport != 0) return;
  const double end = static_cast<double>(to_time_.value_or(recording_.places().end()));
  options_.on_progress(tick.tick, end > 0.0 ? std::min(1.0, static_cast<double>(tick.log_time) / end) : 1.0);
}

}  // namespace troupe
