// Network: the values of all nodes of a program, tick by tick. It is the state of a monitor: a plain value whose copy
// continues by itself, so that a monitor can be copied at a tick and follow two runs. One thread uses an object at a
// time.
//
// Order of evaluation is the order of the nodes in the program, and each fold has one fixed order, so that equal ticks
// give equal bits on every machine, live or from a recording.
//
// Sliding minima and maxima, and the sliding composition of "until", are kept by a fold with two parts: suffixes of the
// older values, computed at once when they begin to leave, and one running value of the newer ones. Each value is
// combined at most three times on average, whatever the length of the window, and all lanes in one loop. The usual
// alternative, a monotonic deque for each lane, costs the same number of comparisons but branches in each lane and
// cannot express "until".
//
// Memory: a window of n ticks keeps n values of each lane; a window without end keeps the series of the whole run,
// since its result depends on the last tick.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "testing/expectations/program.h"
#include "testing/expectations/signals.h"
#include "testing/expectations/tick_view.h"

namespace troupe {

// The lesser of two robustnesses: -0.0, which is false, is less than 0.0. Without a branch: of equal numbers (which
// only zeros of two signs can differ in) the signs are joined by "or" here and by "and" below, so that compilers
// vectorize the loops over lanes.
inline double Least(double a, double b) {
  const std::uint64_t equal = a == b ? std::bit_cast<std::uint64_t>(a) : 0;
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(a < b ? a : b) | equal);
}
inline double Greatest(double a, double b) {
  const std::uint64_t unequal = a == b ? 0 : ~std::uint64_t{0};
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(a > b ? a : b) &
                               (unequal | std::bit_cast<std::uint64_t>(a)));
}

enum class FoldKind : std::uint8_t { kLeast, kGreatest, kUntil };

// The combination of the last values of all lanes: a queue with an aggregate, made of two stacks. Values before middle_
// are already folded up to the middle; when the last of these leaves, the rest is folded again and middle_ moves to the
// end. A value of kUntil has two halves: what is enough, and what must hold on the way to a later one. That combination
// is associative but not commutative, so the order of arguments counts.
class SlidingFold {
 public:
  // At most `width` values at a time.
  void Push(FoldKind kind, Tick width, std::span<const double> values);
  void Pop(FoldKind kind, Tick width, std::size_t stride);  // the oldest
  // REQUIRES: !empty()
  void Read(FoldKind kind, Tick width, std::span<double> values) const;
  bool empty() const { return begin_ == end_; }
  Tick begin() const { return begin_; }  // number of the oldest value, counted from 0
  Tick end() const { return end_; }

 private:
  std::span<double> Slot(Tick number, Tick width, std::size_t stride);

  Tick begin_ = 0;
  Tick middle_ = 0;  // from here on `newer_` has the values
  Tick end_ = 0;
  std::vector<double> slots_;  // value number i at i % width; before middle_, folded with those behind it up to there
  std::vector<double> newer_;
};

class Network {
 public:
  explicit Network(std::shared_ptr<const MonitorProgram> program);

  const MonitorProgram& program() const { return *program_; }

  // Called after each tick of a level, with the number of the tick from 0.
  using OnTick = std::function<void(std::size_t level, Tick now)>;

  void Push(const TickView& tick, const OnTick& on_tick);
  // Plays what is delayed beyond the last tick, then the levels that follow. REQUIRES: a tick has been pushed
  void Finish(const OnTick& on_tick);

  Tick ticks() const { return ticks_; }  // pushed
  // Whether the node has a value in the present call of OnTick, and for which tick, from 0.
  bool IsValid(std::size_t node, Tick now) const;
  Tick TimeOf(std::size_t node, Tick now) const { return now - program_->nodes[node].delay; }
  std::span<const double> values(std::size_t node) const { return states_[node].values; }

  // Appends the things of the variables of the quantifiers that decide a lane of the node at present.
  void FindCause(std::size_t node, std::size_t lane, std::vector<ThingId>& things) const;

 private:
  struct State {
    std::vector<double> values;  // by lane
    SignalMemory memory;
    SlidingFold fold;
    std::vector<double> ring;    // the last values of the input
    std::vector<double> series;  // all values, if they are recorded or played back
    std::vector<double> scratch;
  };

  void Advance(std::size_t level, Tick now, const TickView* tick);
  void Compute(const Node& node, State& state, const TickView* tick);
  void Slide(const Node& node, State& state, Tick now);
  void Shift(const Node& node, State& state, Tick now);
  void Look(const Node& node, State& state, Tick now);
  void LoadSeries(const Node& node, State& state);
  void Reduce(const Node& node, State& state) const;
  bool HasInput(const Node& node, Tick now) const;
  Tick InputDelay(const Node& node) const;

  std::shared_ptr<const MonitorProgram> program_;
  std::vector<State> states_;                     // by node
  std::vector<std::vector<std::size_t>> levels_;  // nodes
  Tick ticks_ = 0;
  bool ended_ = false;
};

// Adds the things of lane `lane` of the product of `variables`.
void AppendThings(const MonitorProgram& program, const std::vector<std::size_t>& variables, std::size_t lane,
                  std::vector<ThingId>& things);

}  // namespace troupe
