// RunStatistics: the status of a run and its summary, from counters and times of the other parts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "world-service/service/live_run.h"
#include "world-service/service/run_summary.h"
#include "world-service/service/tick_engine.h"
#include "world-service/service/world_editor.h"

namespace troupe {

class RunStatistics {
 public:
  // All of them outlive the statistics. `now`: wall time, s.
  RunStatistics(const LiveRun& run, const TickEngine& engine, const WorldEditor& editor, double now)
      : run_(run), engine_(engine), editor_(editor), status_at_(now) {}

  // The run begins: the first period of the real time factor, too.
  void OnBegin(double now) { status_at_ = now; }
  // The real time factor is that since the status before.
  StatusMessage MakeStatus(double now);
  RunSummary MakeSummary() const;

 private:
  std::vector<std::string> MissingRobots(double now) const;
  std::vector<SlowRobot> SlowestRobots() const;

  const LiveRun& run_;
  const TickEngine& engine_;
  const WorldEditor& editor_;
  double status_at_;  // wall time of the newest status, s
  std::uint64_t status_steps_ = 0;
};

}  // namespace troupe
