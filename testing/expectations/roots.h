// Roots: the value at the first tick of the outermost operators of an expectation, as bounds that come closer tick by
// tick, so that a verdict is known as early as possible; and what decides it.
//
// Why apart from the network: an expectation is judged at the first tick only. "always p" as a node would compute a
// value for each tick and wait until the end of the run for the first of them; as a root it is one running minimum, an
// upper bound at each tick, and false as soon as that bound is. The bounds are sound: low <= robustness <= high
// whatever follows, and they only come closer.
//
// Costs: one comparison for each lane and tick. The owner (Monitor) calls it on its own thread, after each tick of the
// network.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "testing/expectations/network.h"
#include "testing/expectations/program.h"
#include "troupe/interval.h"

namespace troupe {

class Roots {
 public:
  explicit Roots(const MonitorProgram& program);

  // Reads the values of the nodes of a level at a tick.
  void Update(const Network& network, std::size_t level, Tick now);
  // The run has ended: nothing will be added to any window.
  void Finish(const Network& network);

  Interval bounds() const;

  struct Cause {
    std::optional<Tick> tick = {};  // from 0
    std::vector<ThingId> things = {};
  };
  Cause FindCause(const MonitorProgram& program) const;

 private:
  struct State {
    std::vector<double> low;  // by lane
    std::vector<double> high;
    std::vector<double> best;  // of a window: the least or greatest value so far
    std::vector<double> way;   // of "until": the least value on the left so far
    std::vector<Tick> when;    // at which best has changed
    std::vector<Tick> way_when;
    std::vector<std::vector<ThingId>> things;  // that have changed it
    bool complete = false;
  };

  // The value of a node that becomes the best of a window.
  struct Decision {
    std::size_t node = 0;
    std::size_t lane = 0;  // of the node
    double value = 0.0;
    Tick time = 0;
  };

  void UpdateRoot(const Network& network, const RootNode& root, State& state, Tick time);
  void UpdateUntil(const Network& network, const RootNode& root, State& state, Tick time);
  void Decide(const Network& network, State& state, std::size_t lane, const Decision& decision);
  void SetBounds(const RootNode& root, State& state) const;
  void Combine(const MonitorProgram& program);
  void AddCause(const MonitorProgram& program, std::size_t root, std::size_t lane, Cause& cause) const;
  double KeyOf(std::size_t root, std::size_t lane, bool is_least) const;

  std::vector<State> states_;  // by root
  bool changed_ = true;
};

}  // namespace troupe
