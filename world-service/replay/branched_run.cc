#include "world-service/replay/branched_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "common/base/random_id.h"
#include "recording/tick_reader.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/replay/restore_run.h"
#include "world-service/replay/run_replay.h"
#include "world-service/service/apply_edit.h"

namespace troupe {
namespace {

// The state of a recording with which the new run begins.
struct Start {
  ReplayedWorld world;
  RecordedTick tick;  // without its inputs
  std::optional<MemoryPlace> previous;
};

Result<Start> FindStart(const Recording& recording, const std::optional<Tick>& from) {
  const TickPlaces& places = recording.places();
  std::uint64_t time = places.end();
  if (from) {
    const std::optional<std::uint64_t> last = places.Last(*from);
    if (!last) {
      return Error{
          {recording.name()},
          fmt::format("found tick {}, expected at most {}, the last of the recording", *from, places.greatest())};
    }
    time = *last;
  }
  const std::size_t chunk = recording.KeyframeBefore(time).value_or(0);
  Result<ReplayedWorld> world = ReplayedWorld::At(recording, chunk);
  if (!world.ok()) return world.error();
  // The last state of the tick at that time, before another tick begins there.
  TickReader reader(recording, chunk);
  std::optional<Start> start;
  RecordedTick tick;
  for (;;) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error();
    if (!more.value() || tick.log_time > time) break;
    if (start && start->tick.log_time == time && from && tick.tick != *from) break;
    if (Status problem = world.value().Follow(tick); !problem.ok()) {
      return Error{
          {recording.name()}, fmt::format("tick {}: {}", tick.tick, problem.error().message), ErrorCode::kFailure};
    }
    if (from && (tick.log_time != time || tick.tick != *from)) continue;
    start.reset();
    start.emplace(Start{ReplayedWorld(world.value()), {}, PreviousOf(tick)});
    start->tick.number = tick.number;
    start->tick.tick = tick.tick;
    start->tick.edition = tick.edition;
    start->tick.log_time = tick.log_time;
  }
  if (!start) return Error{{recording.name()}, "the recording has no state to begin with", ErrorCode::kFailure};
  return std::move(*start);
}

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
      if (!IsThere(world, RobotId(i))) continue;
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
  edit.request.command = ControlCommand::kChange;
  edit.request.source = changes.ToText();
  return tick;
}

}  // namespace

Result<ControllerChange> ParseControllerChange(const std::string& text) {
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
  Result<Recording> opened = Recording::Open(file);
  if (!opened.ok()) return opened.error();
  const auto recording = std::make_shared<const Recording>(std::move(opened).value());
  if (Status version = CheckStepVersion(*recording); !version.ok()) return version.error();
  Result<Start> found = FindStart(*recording, options.from);
  if (!found.ok()) return found.error();
  Start& start = found.value();
  const Result<WorldChanges> changes = ChangesOf(options, start.world.world());
  if (!changes.ok()) return changes.error();

  FrameMessage frame = start.world.Frame();
  BranchedRun branch;
  auto begin = std::make_shared<RecordedBegin>();
  begin->source = recording;
  begin->last_number = start.tick.number;
  branch.resumed.next_number = start.tick.number + 1;
  branch.resumed.previous = start.previous;
  if (changes.value().any()) {
    RecordedTick tick = RecordedChange(changes.value(), frame, branch.resumed.next_number++);
    if (Status refused = start.world.Apply(tick); !refused.ok()) return refused.error();
    frame.edition = frame.world_edition = tick.edition;
    branch.resumed.previous = PreviousOf(tick);
    begin->change = std::move(tick);
  }
  branch.begin = std::move(begin);
  branch.scene = start.world.scene();
  RunSettings& settings = branch.settings;
  settings = recording->run().settings;
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
  resumed.original = start.world.original();
  resumed.scene = branch.scene;
  resumed.frame = std::move(frame);
  if (options.paused) resumed.progress.ticks_to_pause = 0;
  resumed.world_file = recording->run().file;
  return branch;
}

}  // namespace troupe
