// Program: an expectation or a metric, compiled for one world: a graph of operators without names, in an order in which
// each comes after its inputs. Immutable; a monitor (network.h) runs it.
//
// Lanes: a node has a value for each combination of the things of the variables that it depends on, its
// lanes. The lanes of the variables that are bound first change slowest. Truth is a robustness (expectation.h).
//
// Delays: what a node says about tick t it can say at tick t + delay at the earliest. All inputs of a node have the
// same delay and level: the compiler adds kDelay nodes. An operator whose window has no end speaks only after the run:
// it plays back the series of its input, as a source of the next level, whose time begins at the first tick again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "testing/expectations/signals.h"
#include "testing/expectations/syntax.h"
#include "troupe/ids.h"
#include "troupe/vec2.h"

namespace troupe {

inline constexpr Tick kForever = std::numeric_limits<Tick>::max();
inline constexpr std::size_t kMaxLanes = 4'000'000;

// A window of ticks relative to the present one, both ends included.
struct TickWindow {
  Tick from = 0;
  Tick to = kForever;
  bool has_end() const { return to != kForever; }
};

enum class Op : std::uint8_t {
  // Sources.
  kConstant,  // number
  kSignal,    // signal
  // Numbers.
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kNegate,
  kAbsolute,
  kSquareRoot,
  kSmaller,
  kLarger,
  // Numbers to truth.
  kGreater,
  kAtLeast,
  kEqual,
  kUnequal,
  // Truth. kAnd and kOr have any number of inputs.
  kNot,
  kAnd,
  kOr,
  // Over the last `reduced` variables of the input.
  kForall,
  kExists,
  kMinimum,
  kMaximum,
  kSum,
  kMean,
  kCount,
  // Of the same value at other ticks.
  kDelay,      // ticks: only the time at which the value is known
  kPastShift,  // ticks: the value so many ticks ago; `number` before the first tick
  kWindowMin,
  kWindowMax,  // future; window
  kUntil,      // inputs: left, right; window
  kPastMin,
  kPastMax,  // the last `ticks` + 1 values; kForever: all
  kSince,    // inputs: left, right
  // From a lower level: the whole series of the input, as it is; the least or largest from window.from on; the same for
  // "until"; the last value, at all ticks.
  kPlayback,
  kSuffixMin,
  kSuffixMax,
  kSuffixUntil,
  kLastValue,
};

// The lane of an input for each lane of a node. Most often it is the same one.
struct NodeInput {
  std::size_t node = 0;
  std::vector<std::uint32_t> lane_of = {};  // empty: the same; the input's only one if it has one
};

struct Node {
  Op op = Op::kConstant;
  std::vector<NodeInput> inputs = {};
  std::vector<std::size_t> variables = {};  // of Program, ascending
  std::size_t lanes = 1;
  Tick delay = 0;
  std::size_t level = 0;
  double number = 0.0;
  Tick ticks = 0;
  TickWindow window = {};
  SignalUse signal = {};
  // Of a reduction: lanes of its input for each of its own, and those of them that count: different variables of one
  // quantifier stand for different things. Empty: all.
  std::size_t reduced = 1;
  std::vector<std::uint32_t> counted = {};
  std::vector<std::size_t> reduced_variables = {};
  bool recorded = false;     // a node of a higher level plays it back
  bool names_cause = false;  // it or what is below it selects a lane or a pair
};

// The part of a formula that is judged at the first tick only: its bounds are known at every tick.
enum class RootOp : std::uint8_t { kValue, kNot, kAnd, kOr, kForall, kExists, kAlways, kEventually, kUntil, kFinally };

struct RootNode {
  RootOp op = RootOp::kValue;
  std::vector<NodeInput> inputs = {};  // of roots for kNot to kExists, else of nodes
  std::vector<std::size_t> variables = {};
  std::size_t lanes = 1;
  TickWindow window = {};
  std::size_t reduced = 1;
  std::vector<std::uint32_t> counted = {};
  std::vector<std::size_t> reduced_variables = {};
  std::size_t level = 0;  // of its nodes
  bool is_bound = false;  // of another root, with which it is joined: known earlier, and no part of the history
};

struct Variable {
  std::string name;
  std::vector<ThingId> things;  // its domain
};

struct MonitorProgram {
  std::string text;
  std::string formula;
  std::vector<Variable> variables;
  std::vector<Node> nodes;
  std::vector<RootNode> roots;         // the last one is the formula; of a metric: none
  std::optional<std::size_t> history;  // a node of one lane
  std::size_t levels = 1;
  // Of a metric: a number of one or more lanes, or truth.
  MetricKind metric = MetricKind::kFinal;
  std::size_t value = 0;               // node
  std::vector<std::uint32_t> counted;  // lanes of `value`; empty: all
  Dimension dimension;
  // Of the world.
  std::shared_ptr<const Things> things;
  std::int64_t interval_ns = 0;
};

}  // namespace troupe
