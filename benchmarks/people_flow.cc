// What people do in the usual experiments with crowds (people_experiments.h), as CSV on standard output: the
// experiment, its parameter (density, width, number of people), what was measured, and the processor time (us) for each
// person and tick. people_plot.py draws the fundamental diagram from it; docs/people.md has the figures.
//
//   people_flow [SEEDS]
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>

#include "benchmarks/people_experiments.h"

#ifdef TROUPE_PEER_RVO2
#include "benchmarks/peers/rvo2_run.h"
#endif

namespace troupe::bench {
namespace {

#ifdef TROUPE_PEER_RVO2
using Base = Rvo2Run;
#else
using Base = CrowdRun;
#endif

// Counts the steps of people, and their processor time.
class TimedRun : public Base {
 public:
  using Base::Base;
  void Step() {
    const std::clock_t before = std::clock();
    StepOnly();
    clocks += std::clock() - before;
    steps += size();
    Measure();
  }
  static void Reset() { clocks = steps = 0; }
  // us for each person and tick
  static double Cost() { return 1e6 * static_cast<double>(clocks) / CLOCKS_PER_SEC / static_cast<double>(steps); }

 private:
  inline static std::clock_t clocks = 0;
  inline static std::size_t steps = 0;
};

void Print(const char* experiment, double parameter, const char* quantity, double value, double gap) {
  fmt::print("{},{:.2f},{},{:.3f},{:.4f},{:.2f}\n", experiment, parameter, quantity, value, gap, TimedRun::Cost());
  std::fflush(stdout);
  TimedRun::Reset();
}

void Run(std::uint64_t seeds) {
  fmt::print("experiment,parameter,quantity,value,least_gap,us\n");
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    for (const double width : {0.8, 1.0, 1.2, 1.6, 2.0, 2.4}) {
      const OpeningFlow result = MeasureOpening<TimedRun>(width, 100, seed);
      Print("opening", width, "flow", result.flow, result.least_gap);
    }
    for (int quarters = 1; quarters < 16; ++quarters) {
      const double density = 0.25 * quarters;
      const CorridorFlow result = MeasureCorridor<TimedRun>(density, seed);
      Print("corridor", result.density, "speed", result.speed, result.least_gap);
    }
    for (const std::size_t people : {40U, 100U}) {
      const Passage result = RunToGoals<TimedRun>(CrossingWorld(4.0, people, seed), 200.0, 12.0);
      Print("crossing", static_cast<double>(people), "seconds", result.seconds, result.least_gap);
    }
    for (const std::size_t people : {16U, 32U}) {
      const Passage result = RunToGoals<TimedRun>(CircleWorld(8.0, people, seed), 200.0);
      Print("circle", static_cast<double>(people), "seconds", result.seconds, result.least_gap);
    }
    for (const double density : {0.3, 0.5, 1.0, 1.5}) {
      const RingFlow result = MeasureRing<TimedRun>(2.4, density, 2, seed);
      Print("both ways", result.density, "speed", result.speed, result.least_gap);
      Print("both ways", result.density, "order", result.order, result.least_gap);
    }
  }
}

}  // namespace
}  // namespace troupe::bench

int main(int count, char** arguments) {
  troupe::bench::Run(count > 1 ? std::strtoul(arguments[1], nullptr, 10) : 1);
}
