#include "world-service/program/prepared_run.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

#include "recording/journal.h"
#include "world-service/observers/recorder/make_recorders.h"
#include "world-service/replay/branched_run.h"
#include "world-service/replay/journal_history.h"
#include "world-service/replay/journal_rewind.h"
#include "world-service/replay/restore_run.h"

namespace troupe {
namespace {

Result<PreparedRun> LoadFile(const ServiceCommandLine& line) {
  if (line.file.empty()) {
    return Error{{line.outputs.journal->recording}, "found a journal without a run, expected one to resume"};
  }
  Result<LoadedWorld> loaded = LoadWorld(line.file, line.overrides);
  if (!loaded.ok()) return loaded.error();
  for (const Warning& warning : loaded.value().warnings) fmt::print(stderr, "{}\n", warning.ToString());
  PreparedRun run;
  run.loaded = std::move(loaded).value();
  line.run.ApplyTo(run.loaded.settings);
  run.options = line.service;
  run.options.world_file = line.file;
  // Its agents know that it is not the service that they were started for.
  if (line.resume) run.options.first_incarnation = 1;
  run.scene = std::make_shared<const Scene>(run.loaded.world);
  run.first_world = std::make_shared<const WorldDescription>(run.loaded.world);
  return run;
}

Result<PreparedRun> Branch(const ServiceCommandLine& line) {
  Result<BranchedRun> branch = BranchRun(line.file, {line.branch.from_tick, line.overrides.seed,
                                                     line.branch.controllers, line.run, line.service.start_paused});
  if (!branch.ok()) return branch.error();
  PreparedRun run;
  run.loaded = std::move(branch.value().loaded);
  run.options = line.service;
  run.options.world_file = branch.value().resumed.world_file;
  run.options.resumed = std::move(branch.value().resumed);
  run.scene = branch.value().scene;
  run.begin = branch.value().begin;
  run.first_world = std::make_shared<const WorldDescription>(run.loaded.world);
  return run;
}

// Writes the rest of a rewind within which the service before died.
Status FinishRewind(ResumedRun& run, RunRecorder& recorder, RunObservers observers) {
  const UnfinishedRewind rewind = *std::exchange(run.rewind, std::nullopt);
  recorder.StartWriting();
  Result<std::unique_ptr<JournalRewind>> states =
      JournalRewind::Finish({&recorder}, rewind, *run.frame, run.next_number);
  if (!states.ok()) return states.error();
  for (bool has_more = true; has_more;) {
    const Result<bool> more = states.value()->MakeSome();
    if (!more.ok()) return more.error();
    has_more = more.value();
  }
  Result<RewoundRun> end = states.value()->Write();
  if (!end.ok()) return end.error();
  const WorldState before = std::move(run.frame->state);
  run.frame = std::move(end.value().frame);
  run.scene = end.value().scene;
  run.original = end.value().original;
  run.previous = end.value().previous;
  run.next_number = rewind.number + rewind.copies + 1;
  const AppliedEdit edit{rewind.request};
  const CommittedTick tick{.frame = *run.frame, .proposals = {}, .edit = &edit, .before = &before, .is_recorded = true};
  observers.push_back(&recorder);
  for (RunObserver* observer : observers) {
    observer->OnWorldChange(run.scene, run.frame->edition);
    if (Status failure = observer->OnTick(tick); !failure.ok()) return failure;
  }
  return {};
}

Result<PreparedRun> Resume(Journal journal, const ServiceCommandLine& line) {
  const RecordedRun begin = journal.recording.run();
  PreparedRun run;
  run.first_world = std::make_shared<const WorldDescription>(begin.world);
  Result<std::unique_ptr<Recorder>> texts = MakeTextRecorder(*run.first_world, line.outputs);
  if (!texts.ok()) return texts.error();
  RunObservers told;
  if (texts.value() != nullptr) told.push_back(texts.value().get());
  Result<ResumedRun> resumed = RestoreRun(journal, told);
  if (!resumed.ok()) return resumed.error();
  Result<std::unique_ptr<RunRecorder>> recorder =
      RunRecorder::Continue(std::move(journal), resumed.value(), RecordingOptionsOf(line.outputs, begin.file));
  if (!recorder.ok()) return recorder.error();
  if (resumed.value().rewind) {
    if (Status failure = FinishRewind(resumed.value(), *recorder.value(), told); !failure.ok()) {
      return failure.error();
    }
  }
  run.recorders.recordings = {recorder.value().get()};
  run.recorders.observers.push_back(std::move(recorder).value());
  if (texts.value() != nullptr) run.recorders.observers.push_back(std::move(texts).value());

  run.scene = resumed.value().scene;
  run.loaded.world = run.scene->world();
  run.loaded.settings = begin.settings;
  line.run.ApplyTo(run.loaded.settings);
  run.options = line.service;
  run.options.world_file = resumed.value().world_file.empty() ? begin.file : resumed.value().world_file;
  // Models may be spawned from all files that the run was loaded from, if they are here.
  Result<LoadedWorld> file = LoadWorld(begin.file, line.overrides);
  if (file.ok()) run.loaded.files = std::move(file.value().files);
  run.options.resumed = std::move(resumed).value();
  return run;
}

}  // namespace

Result<PreparedRun> PrepareRun(const ServiceCommandLine& line) {
  std::optional<Journal> journal;
  if (line.resume) {
    Result<std::optional<Journal>> opened = Journal::OpenToContinue(*line.outputs.journal);
    if (!opened.ok()) return opened.error();
    journal = std::move(opened).value();
  }
  const bool is_branch = IsRecordingPath(line.file);
  Result<PreparedRun> run = journal ? Resume(std::move(*journal), line) : (is_branch ? Branch(line) : LoadFile(line));
  if (!run.ok()) return run;
  ServiceOptions& options = run.value().options;
  options.settings = run.value().loaded.settings;
  options.overrides = line.overrides;
  RestrictRequests(line.permissions, run.value().loaded, options);
  return run;
}

Status MakeRecordersOf(PreparedRun& run, const ServiceCommandLine& line) {
  const std::optional<ResumedRun>& resumed = run.options.resumed;
  if (!resumed || resumed->is_branch) {
    const bool needs_memory = resumed || run.options.settings.on_agent_loss == OnAgentLoss::kRebuild;
    OutputFiles outputs = line.outputs;
    outputs.begin = run.begin;
    Result<Recorders> recorders = MakeRecorders(*run.first_world, outputs, run.options.world_file, needs_memory);
    if (!recorders.ok()) return recorders.error();
    run.recorders = std::move(recorders).value();
  }
  run.history = MakeRunHistory(run.recorders.recordings);
  run.options.history = run.history.get();
  return {};
}

}  // namespace troupe
