// PreparedRun: the world and the output files with which the world service begins a run, or continues one.
#pragma once

#include <memory>

#include "common/spatial/scene.h"
#include "troupe/result.h"
#include "world-service/observers/recorder/make_recorders.h"
#include "world-service/program/command_line.h"
#include "world-service/service/run_history.h"
#include "worldfile/load_world.h"

namespace troupe {

struct PreparedRun {
  LoadedWorld loaded;  // the file; of a run that is continued, its world and settings now
  ServiceOptions options;
  std::shared_ptr<const Scene> scene;                   // of the loaded world
  std::shared_ptr<const WorldDescription> first_world;  // of which the recorders have the names
  std::shared_ptr<const RecordedBegin> begin;           // of the recordings; null: they begin with the run
  Recorders recorders;
  std::unique_ptr<RunHistory> history;  // null: none
};

// Loads the file of the command line, whose warnings are printed, or the newest state of the journal to be resumed. If
// that journal has no run yet, the file. The recorders of a new run are made by MakeRecordersOf, once nothing else can
// fail.
Result<PreparedRun> PrepareRun(const ServiceCommandLine& line);
// Also makes the history.
Status MakeRecordersOf(PreparedRun& run, const ServiceCommandLine& line);

}  // namespace troupe
