// SimulationRecorder: records the steps of a Simulation into a file as `troupe run --record` makes it
// (docs/recording.md), which `troupe replay`, `troupe view`, `troupe export` and RecordedSimulation read.
//
// What came about in another way than by a step (an edit, a restored snapshot) is recorded as a whole state, so that
// the recording is one sequence of states that proves itself in a replay.
//
// Threads: as the simulation.
#pragma once

#include <memory>
#include <string>

#include "troupe/ids.h"
#include "troupe/result.h"
#include "troupe/simulation.h"

namespace troupe {

struct SimulationRecorderOptions {
  Tick keyframe_interval = 100;  // at least 1: states from which a reader can begin
};

class SimulationRecorder {
 public:
  // Creates the file, with the present state. The error names the file that cannot be written, or that another process
  // writes.
  static Result<SimulationRecorder> Create(const std::string& file, const Simulation& simulation,
                                           const SimulationRecorderOptions& options = {});

  SimulationRecorder(SimulationRecorder&& other) noexcept;
  SimulationRecorder& operator=(SimulationRecorder&& other) noexcept;
  ~SimulationRecorder();  // as Close

  // Before and after each step of one tick, of the simulation of Create. The error is that of the file, or a tick that
  // was left out.
  Status BeforeStep(const Simulation& simulation);
  Status AfterStep(const Simulation& simulation);
  // Writes what is left, and closes the file: it is whole only then. A further call does nothing.
  Status Close();

 private:
  struct Impl;
  explicit SimulationRecorder(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;  // null only after a move
};

}  // namespace troupe
