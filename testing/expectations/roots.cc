#include "testing/expectations/roots.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe {
namespace {

bool IsCombination(RootOp op) {
  return op == RootOp::kNot || op == RootOp::kAnd || op == RootOp::kOr || op == RootOp::kForall ||
         op == RootOp::kExists;
}

// Zeros of two signs differ: -0 counts as violated, 0 as fulfilled.
bool IsSame(double a, double b) {
  return a == b && std::signbit(a) == std::signbit(b);
}

// An input without variables has one value for all lanes.
std::size_t LaneOf(const NodeInput& input, std::size_t lane, std::size_t input_lanes) {
  if (!input.lane_of.empty()) return input.lane_of[lane];
  return input_lanes == 1 ? 0 : lane;
}

// Calls visit(i) for the lanes of the input of a quantifier that count.
template <typename Visit>
void ForEachCounted(const RootNode& root, std::size_t lane, const Visit& visit) {
  if (root.counted.empty()) {
    for (std::size_t i = 0; i < root.reduced; ++i) visit(lane * root.reduced + i);
  } else {
    for (const std::uint32_t i : root.counted) visit(lane * root.reduced + i);
  }
}

}  // namespace

Roots::Roots(const MonitorProgram& program) : states_(program.roots.size()) {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const RootNode& root = program.roots[i];
    State& state = states_[i];
    // Nothing is known yet: the bounds are all that a robustness can be.
    state.low.assign(root.lanes, -kInfinity);
    state.high.assign(root.lanes, kInfinity);
    if (IsCombination(root.op)) continue;
    state.best.assign(root.lanes, root.op == RootOp::kAlways ? kInfinity : -kInfinity);
    state.when.assign(root.lanes, 0);
    if (root.op == RootOp::kUntil) {
      state.way.assign(root.lanes, kInfinity);
      state.way_when.assign(root.lanes, 0);
    }
    // Things are kept only for roots under which something selects: most expectations then cost no allocation.
    const bool names = std::any_of(root.inputs.begin(), root.inputs.end(),
                                   [&](const NodeInput& input) { return program.nodes[input.node].names_cause; });
    if (names) state.things.resize(root.lanes);
  }
}

void Roots::Update(const Network& network, std::size_t level, Tick now) {
  const MonitorProgram& program = network.program();
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const RootNode& root = program.roots[i];
    if (IsCombination(root.op) || root.level != level || states_[i].complete) continue;
    // All inputs have one delay, but constants, which have a value at any time.
    std::size_t timed = root.inputs[0].node;
    for (const NodeInput& input : root.inputs) {
      if (program.nodes[input.node].op != Op::kConstant) timed = input.node;
    }
    if (network.IsValid(timed, now)) UpdateRoot(network, root, states_[i], network.TimeOf(timed, now));
  }
  if (changed_) Combine(program);
}

// Only what improves the best value so far is a decision; its tick and things are the cause that users see.
void Roots::UpdateRoot(const Network& network, const RootNode& root, State& state, Tick time) {
  if (root.op == RootOp::kValue || root.op == RootOp::kFinally) {
    if (root.op == RootOp::kValue && time > 0) return;
  } else if (time > root.window.to || (root.op != RootOp::kUntil && time < root.window.from)) {
    return;
  }
  const std::size_t node = root.inputs[0].node;
  const std::span<const double> values = network.values(node);
  switch (root.op) {
    case RootOp::kValue:
    case RootOp::kFinally:
      for (std::size_t i = 0; i < root.lanes; ++i) {
        const std::size_t lane = LaneOf(root.inputs[0], i, values.size());
        Decide(network, state, i, {node, lane, values[lane], time});
      }
      state.complete = root.op == RootOp::kValue;
      break;
    case RootOp::kAlways:
    case RootOp::kEventually: {
      const bool is_always = root.op == RootOp::kAlways;
      const bool is_first = time == root.window.from;
      for (std::size_t i = 0; i < root.lanes; ++i) {
        const std::size_t lane = LaneOf(root.inputs[0], i, values.size());
        const double value = values[lane];
        const double best = state.best[i];
        // Most values decide nothing; zeros of two signs are compared below.
        const bool is_better = is_always ? value < best : value > best;
        if (!is_better && !is_first && (value != 0.0 || best != 0.0)) continue;
        if (is_first || !IsSame(is_always ? Least(value, best) : Greatest(value, best), best))
          Decide(network, state, i, {node, lane, value, time});
      }
      break;
    }
    default:
      UpdateUntil(network, root, state, time);
  }
  if (root.window.has_end() && time == root.window.to) {
    state.complete = true;
    changed_ = true;
  }
  if (changed_) SetBounds(root, state);
}

// `way` is the least robustness of the left side up to here: the right side cannot count for more.
void Roots::UpdateUntil(const Network& network, const RootNode& root, State& state, Tick time) {
  const std::span<const double> left = network.values(root.inputs[0].node);
  const std::size_t right_node = root.inputs[1].node;
  const std::span<const double> right = network.values(right_node);
  for (std::size_t i = 0; i < root.lanes; ++i) {
    const std::size_t left_lane = LaneOf(root.inputs[0], i, left.size());
    const std::size_t right_lane = LaneOf(root.inputs[1], i, right.size());
    if (time >= root.window.from) {
      const double value = Least(state.way[i], right[right_lane]);
      if (!IsSame(Greatest(value, state.best[i]), state.best[i])) {
        const bool is_right = right[right_lane] < state.way[i];
        Decide(network, state, i, {right_node, right_lane, value, is_right ? time : state.way_when[i]});
      }
    }
    const double way = Least(state.way[i], left[left_lane]);
    if (!IsSame(way, state.way[i])) {
      state.way[i] = way;
      state.way_when[i] = time;
      changed_ = true;
    }
  }
}

void Roots::Decide(const Network& network, State& state, std::size_t lane, const Decision& decision) {
  state.best[lane] = decision.value;
  state.when[lane] = decision.time;
  changed_ = true;
  if (state.things.empty()) return;
  state.things[lane].clear();
  network.FindCause(decision.node, decision.lane, state.things[lane]);
}

// The robustness of the whole run lies between the two whatever follows; they meet when it is decided.
void Roots::SetBounds(const RootNode& root, State& state) const {
  for (std::size_t i = 0; i < root.lanes; ++i) {
    const double best = state.best[i];
    const bool complete = state.complete;
    switch (root.op) {
      case RootOp::kAlways:
        state.low[i] = complete ? best : -kInfinity;
        state.high[i] = best;
        break;
      case RootOp::kEventually:
        state.low[i] = best;
        state.high[i] = complete ? best : kInfinity;
        break;
      case RootOp::kUntil:
        state.low[i] = best;
        state.high[i] = complete ? best : Greatest(best, state.way[i]);
        break;
      default:
        state.low[i] = complete ? best : -kInfinity;
        state.high[i] = complete ? best : kInfinity;
    }
  }
}

void Roots::Finish(const Network& network) {
  const MonitorProgram& program = network.program();
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (IsCombination(program.roots[i].op)) continue;
    states_[i].complete = true;
    SetBounds(program.roots[i], states_[i]);
  }
  Combine(program);
}

// Inputs of a combination precede it in the list, so one pass suffices.
void Roots::Combine(const MonitorProgram& program) {
  changed_ = false;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const RootNode& root = program.roots[k];
    if (!IsCombination(root.op)) continue;
    State& state = states_[k];
    const bool is_least = root.op == RootOp::kAnd || root.op == RootOp::kForall;
    for (std::size_t lane = 0; lane < root.lanes; ++lane) {
      if (root.op == RootOp::kNot) {
        const State& inner = states_[root.inputs[0].node];
        const std::size_t i = LaneOf(root.inputs[0], lane, inner.low.size());
        state.low[lane] = -inner.high[i];
        state.high[lane] = -inner.low[i];
        continue;
      }
      double low = is_least ? kInfinity : -kInfinity;
      double high = low;
      const auto add = [&](const State& inner, std::size_t i) {
        low = is_least ? Least(low, inner.low[i]) : Greatest(low, inner.low[i]);
        high = is_least ? Least(high, inner.high[i]) : Greatest(high, inner.high[i]);
      };
      if (root.op == RootOp::kAnd || root.op == RootOp::kOr) {
        for (const NodeInput& input : root.inputs) {
          const State& inner = states_[input.node];
          add(inner, LaneOf(input, lane, inner.low.size()));
        }
      } else {
        const State& inner = states_[root.inputs[0].node];
        ForEachCounted(root, lane, [&](std::size_t i) { add(inner, i); });
      }
      state.low[lane] = low;
      state.high[lane] = high;
    }
  }
}

Interval Roots::bounds() const {
  return {states_.back().low[0], states_.back().high[0]};
}

// The value of a lane, or, while it is open, the bound that tells more of it. One of which nothing is known decides
// nothing.
double Roots::KeyOf(std::size_t root, std::size_t lane, bool is_least) const {
  const double low = states_[root].low[lane];
  const double high = states_[root].high[lane];
  if (low == -kInfinity && high == kInfinity) return is_least ? kInfinity : -kInfinity;
  return high < kInfinity ? high : low;
}

// Follows the operand that decides, from the whole formula down to one temporal operator.
void Roots::AddCause(const MonitorProgram& program, std::size_t number, std::size_t lane, Cause& cause) const {
  const RootNode& root = program.roots[number];
  const State& state = states_[number];
  if (!IsCombination(root.op)) {
    cause.tick = state.when[lane];
    if (!state.complete && root.op == RootOp::kFinally) cause.tick.reset();
    // Before "until" has found its right side, what its left side has lost decides.
    if (root.op == RootOp::kUntil && state.best[lane] == -kInfinity) cause.tick = state.way_when[lane];
    if (!state.things.empty()) {
      cause.things.insert(cause.things.end(), state.things[lane].begin(), state.things[lane].end());
    }
    return;
  }
  const bool is_least = root.op == RootOp::kAnd || root.op == RootOp::kForall;
  std::optional<std::pair<std::size_t, std::size_t>> best;  // root and lane
  const auto consider = [&](std::size_t its_root, std::size_t its_lane) {
    const double key = KeyOf(its_root, its_lane, is_least);
    const double least = best ? KeyOf(best->first, best->second, is_least) : 0.0;
    if (!best || (is_least ? key < least : key > least)) best = {its_root, its_lane};
  };
  if (root.op == RootOp::kForall || root.op == RootOp::kExists) {
    ForEachCounted(root, lane, [&](std::size_t i) { consider(root.inputs[0].node, i); });
    if (!best) return;
    AppendThings(program, root.reduced_variables, best->second % root.reduced, cause.things);
  } else {
    for (const NodeInput& input : root.inputs) {
      consider(input.node, LaneOf(input, lane, states_[input.node].low.size()));
    }
  }
  AddCause(program, best->first, best->second, cause);
}

Roots::Cause Roots::FindCause(const MonitorProgram& program) const {
  Cause cause;
  AddCause(program, states_.size() - 1, 0, cause);
  return cause;
}

}  // namespace troupe
