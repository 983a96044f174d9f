// RunSummary: the outcome of a run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace troupe {

struct SlowRobot {
  std::string robot;
  std::uint64_t times_last = 0;  // ticks in which its proposal was the last to arrive
  double waited_seconds = 0.0;   // wall time that the barrier waited for it alone
};

struct RunSummary {
  std::uint64_t ticks = 0;
  double sim_seconds = 0.0;
  double wall_seconds = 0.0;  // from the first tick to the last
  double real_time_factor = 0.0;
  double startup_seconds = 0.0;  // from the start of RunService to the first tick
  std::uint32_t robots = 0;
  std::uint64_t stalls = 0;    // kStallBegan events
  std::uint64_t rejected = 0;  // rejected proposals, reported as events or not
  std::uint64_t frames_repeated = 0;
  std::uint64_t state_hash = 0;
  std::vector<SlowRobot> slowest;  // at most five, slowest first
  std::vector<std::string> lost;   // robots without an agent at the end
  bool interrupted = false;
  double record_waited_seconds = 0.0;  // wall time that ticks waited for an observer, the recording
};

}  // namespace troupe
