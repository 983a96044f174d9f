#include "testing/expectations/network.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "testing/expectations/operators.h"

namespace troupe {
namespace {

// `later` is the value of the later ticks, and becomes the combination.
void Combine(FoldKind kind, std::span<const double> earlier, std::span<double> later) {
  const std::size_t count = later.size();
  if (kind == FoldKind::kLeast) {
    for (std::size_t i = 0; i < count; ++i) later[i] = Least(earlier[i], later[i]);
  } else if (kind == FoldKind::kGreatest) {
    for (std::size_t i = 0; i < count; ++i) later[i] = Greatest(earlier[i], later[i]);
  } else {
    // max(enough, min(way, x)) after the same of the later ones.
    const std::size_t lanes = count / 2;
    for (std::size_t i = 0; i < lanes; ++i) {
      later[i] = Greatest(earlier[i], Least(earlier[lanes + i], later[i]));
      later[lanes + i] = Least(earlier[lanes + i], later[lanes + i]);
    }
  }
}

// Four folds side by side, which need not wait for each other. REQUIRES: the order does not count
template <typename Combination>
double FoldInStrands(std::span<const double> values, double start, const Combination& combine) {
  std::array<double, 4> strands{start, start, start, start};
  std::size_t i = 0;
  for (; i + 4 <= values.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) strands[k] = combine(strands[k], values[i + k]);
  }
  for (; i < values.size(); ++i) strands[0] = combine(strands[0], values[i]);
  return combine(combine(strands[0], strands[1]), combine(strands[2], strands[3]));
}

FoldKind KindOf(Op op) {
  if (op == Op::kUntil) return FoldKind::kUntil;
  return op == Op::kWindowMin || op == Op::kPastMin ? FoldKind::kLeast : FoldKind::kGreatest;
}

// Calls compute(lane, a, b) for each lane with the values of two inputs.
template <typename Compute>
void ForEachLane(const Node& node, std::span<const double> a, std::span<const double> b, const Compute& compute) {
  const NodeInput& left = node.inputs[0];
  const NodeInput& right = node.inputs[1];
  if (left.lane_of.empty() && right.lane_of.empty() && a.size() == node.lanes && b.size() == node.lanes) {
    for (std::size_t i = 0; i < node.lanes; ++i) compute(i, a[i], b[i]);
    return;
  }
  if (left.lane_of.empty() && right.lane_of.empty() && a.size() == node.lanes) {
    const double other = b[0];
    for (std::size_t i = 0; i < node.lanes; ++i) compute(i, a[i], other);
    return;
  }
  for (std::size_t i = 0; i < node.lanes; ++i) {
    const std::size_t from_left = !left.lane_of.empty() ? left.lane_of[i] : a.size() == 1 ? 0 : i;
    const std::size_t from_right = !right.lane_of.empty() ? right.lane_of[i] : b.size() == 1 ? 0 : i;
    compute(i, a[from_left], b[from_right]);
  }
}

// Copies the values of an input to the lanes of a node.
void Spread(const NodeInput& input, std::span<const double> from, std::span<double> to) {
  if (!input.lane_of.empty()) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[input.lane_of[i]];
  } else if (from.size() == 1) {
    std::fill(to.begin(), to.end(), from[0]);
  } else {
    std::copy(from.begin(), from.end(), to.begin());
  }
}

}  // namespace

std::span<double> SlidingFold::Slot(Tick number, Tick width, std::size_t stride) {
  return std::span(slots_).subspan(number % width * stride, stride);
}

void SlidingFold::Push(FoldKind kind, Tick width, std::span<const double> values) {
  const std::size_t stride = values.size();
  // The ring grows as values come: a window may be as long as 10^9 ticks, while runs are short.
  if (slots_.size() < (end_ % width + 1) * stride) slots_.resize((end_ % width + 1) * stride);
  std::copy(values.begin(), values.end(), Slot(end_, width, stride).begin());
  if (middle_ == end_) {
    // No newer value yet: the running value begins with this one.
    newer_.assign(values.begin(), values.end());
  } else if (kind == FoldKind::kUntil) {
    std::vector<double> latest(values.begin(), values.end());
    Combine(kind, newer_, latest);
    newer_ = std::move(latest);
  } else {
    Combine(kind, values, newer_);  // the order does not count
  }
  ++end_;
}

void SlidingFold::Pop(FoldKind kind, Tick width, std::size_t stride) {
  if (begin_ == middle_) {
    // The folded part is used up: fold what has gathered, from the end to the beginning, so that each slot is the
    // combination from its value to the end. It happens once for as many pops as it costs combinations.
    for (Tick i = end_ - 1; i-- > middle_;) {
      std::span<double> later = Slot(i + 1, width, stride);
      std::span<double> slot = Slot(i, width, stride);
      if (kind != FoldKind::kUntil) {
        Combine(kind, later, slot);
        continue;
      }
      // "until" composes in the order of time, and its halves depend on each other: not in place.
      std::vector<double> combined(later.begin(), later.end());
      Combine(kind, slot, combined);
      std::copy(combined.begin(), combined.end(), slot.begin());
    }
    middle_ = end_;
  }
  ++begin_;
}

void SlidingFold::Read(FoldKind kind, Tick width, std::span<double> values) const {
  if (middle_ < end_) std::copy(newer_.begin(), newer_.end(), values.begin());
  if (begin_ == middle_) return;
  const std::span<const double> oldest = std::span(slots_).subspan(begin_ % width * values.size(), values.size());
  if (middle_ == end_) {
    std::copy(oldest.begin(), oldest.end(), values.begin());
  } else {
    Combine(kind, oldest, values);
  }
}

Network::Network(std::shared_ptr<const MonitorProgram> program)
    : program_(std::move(program)), states_(program_->nodes.size()), levels_(program_->levels) {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const Node& node = program_->nodes[i];
    states_[i].values.assign(node.lanes, node.op == Op::kConstant ? node.number : 0.0);
    levels_[node.level].push_back(i);
  }
}

bool Network::IsValid(std::size_t node, Tick now) const {
  const Tick delay = program_->nodes[node].delay;
  return now >= delay && (!ended_ || now - delay < ticks_);
}

Tick Network::InputDelay(const Node& node) const {
  Tick delay = 0;
  for (const NodeInput& input : node.inputs) delay = std::max(delay, program_->nodes[input.node].delay);
  return delay;
}

bool Network::HasInput(const Node& node, Tick now) const {
  const Tick delay = InputDelay(node);
  return now >= delay && (!ended_ || now - delay < ticks_);
}

void Network::Push(const TickView& tick, const OnTick& on_tick) {
  Advance(0, ticks_, &tick);
  on_tick(0, ticks_);
  ++ticks_;
}

void Network::Finish(const OnTick& on_tick) {
  ended_ = true;
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    std::vector<Tick> delays{0};
    for (const std::size_t node : levels_[level]) {
      delays.push_back(program_->nodes[node].delay);
      if (level > 0) LoadSeries(program_->nodes[node], states_[node]);
    }
    std::sort(delays.begin(), delays.end());
    // Only the ticks at which some node has a value: delays may be far beyond a short run.
    Tick now = level == 0 ? ticks_ : 0;
    // Level by level: a source of level n plays back series that level n - 1 has completed.
    for (const Tick delay : delays) {
      now = std::max(now, delay);
      for (; now < delay + ticks_; ++now) {
        Advance(level, now, nullptr);
        on_tick(level, now);
      }
    }
  }
}

void Network::Advance(std::size_t level, Tick now, const TickView* tick) {
  for (const std::size_t i : levels_[level]) {
    const Node& node = program_->nodes[i];
    State& state = states_[i];
    switch (node.op) {
      case Op::kConstant:
        break;
      case Op::kDelay:
      case Op::kPastShift:
        Shift(node, state, now);
        break;
      case Op::kWindowMin:
      case Op::kWindowMax:
      case Op::kUntil:
        Slide(node, state, now);
        break;
      case Op::kPastMin:
      case Op::kPastMax:
      case Op::kSince:
        Look(node, state, now);
        break;
      case Op::kPlayback:
      case Op::kSuffixMin:
      case Op::kSuffixMax:
      case Op::kSuffixUntil:
      case Op::kLastValue:
        if (now < ticks_) {
          const auto from = state.series.begin() + static_cast<std::ptrdiff_t>(now * node.lanes);
          std::copy(from, from + static_cast<std::ptrdiff_t>(node.lanes), state.values.begin());
        }
        break;
      default:
        if (IsValid(i, now)) Compute(node, state, tick);
    }
    // Once for each tick, in their order: the series has no gap, and its index is the tick.
    if (node.recorded && IsValid(i, now)) {
      state.series.insert(state.series.end(), state.values.begin(), state.values.end());
    }
  }
}

void Network::Compute(const Node& node, State& state, const TickView* tick) {
  const std::span<double> out(state.values);
  if (node.op == Op::kSignal) {
    ReadSignal(node.signal, *program_->things, *tick, state.memory, out);
    return;
  }
  const std::span<const double> a = values(node.inputs[0].node);
  // The operator is chosen once, and the loop over lanes is compiled for it.
  const bool is_computed = VisitOperator(node.op, [&]<Op op>() {
    if (IsUnary(op)) {
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = Apply<op>(a[i], 0.0);
    } else {
      ForEachLane(node, a, values(node.inputs[1].node),
                  [&](std::size_t i, double left, double right) { out[i] = Apply<op>(left, right); });
    }
  });
  if (is_computed) return;
  switch (node.op) {
    case Op::kAnd:
    case Op::kOr: {
      Spread(node.inputs[0], a, out);
      const bool is_and = node.op == Op::kAnd;
      for (std::size_t k = 1; k < node.inputs.size(); ++k) {
        const NodeInput& input = node.inputs[k];
        std::span<const double> other = values(input.node);
        if (!input.lane_of.empty() || other.size() != out.size()) {
          state.scratch.resize(out.size());
          Spread(input, other, state.scratch);
          other = state.scratch;
        }
        Combine(is_and ? FoldKind::kLeast : FoldKind::kGreatest, other, out);
      }
      return;
    }
    default:
      return Reduce(node, state);
  }
}

void Network::Reduce(const Node& node, State& state) const {
  const std::span<const double> from = values(node.inputs[0].node);
  const std::size_t count = node.counted.empty() ? node.reduced : node.counted.size();
  for (std::size_t lane = 0; lane < node.lanes; ++lane) {
    const std::span<const double> block = from.subspan(lane * node.reduced, node.reduced);
    const auto fold = [&](double result, const auto& combine) {
      if (node.counted.empty()) {
        for (const double value : block) result = combine(result, value);
      } else {
        for (const std::uint32_t i : node.counted) result = combine(result, block[i]);
      }
      return result;
    };
    double& out = state.values[lane];
    switch (node.op) {
      case Op::kForall:
      case Op::kExists: {
        const bool is_least = node.op == Op::kForall;
        const auto combine = [&](double x, double y) { return is_least ? Least(x, y) : Greatest(x, y); };
        const double start = is_least ? kInfinity : -kInfinity;
        // Minimum and maximum may be folded in any order, sums may not: their bits would depend on it.
        out = node.counted.empty() ? FoldInStrands(block, start, combine) : fold(start, combine);
        break;
      }
      case Op::kMinimum:
        out = fold(kInfinity, [](double x, double y) { return y < x ? y : x; });
        break;
      case Op::kMaximum:
        out = fold(-kInfinity, [](double x, double y) { return y > x ? y : x; });
        break;
      case Op::kCount:
        // The sign bit is the truth: -0.0 does not count.
        out = fold(0.0, [](double x, double y) { return x + (std::signbit(y) ? 0.0 : 1.0); });
        break;
      default:
        out = fold(0.0, [](double x, double y) { return x + y; });
        if (node.op == Op::kMean) out /= static_cast<double>(count);
    }
  }
}

void Network::Shift(const Node& node, State& state, Tick now) {
  const Tick delay = InputDelay(node);
  const Tick size = node.ticks + 1;
  const std::size_t lanes = node.lanes;
  if (HasInput(node, now)) {
    const std::span<const double> in = values(node.inputs[0].node);
    const std::size_t slot = (now - delay) % size;
    if (state.ring.size() < (slot + 1) * lanes) state.ring.resize((slot + 1) * lanes);
    std::copy(in.begin(), in.end(), state.ring.begin() + static_cast<std::ptrdiff_t>(slot * lanes));
  }
  if (now < node.delay || (ended_ && now - node.delay >= ticks_)) return;
  // Before the first tick there was nothing: the neutral element of the minimum or maximum.
  if (node.op == Op::kPastShift && now - delay < node.ticks) {
    std::fill(state.values.begin(), state.values.end(), node.number);
    return;
  }
  const auto from = state.ring.begin() + static_cast<std::ptrdiff_t>((now - delay - node.ticks) % size * lanes);
  std::copy(from, from + static_cast<std::ptrdiff_t>(lanes), state.values.begin());
}

void Network::Slide(const Node& node, State& state, Tick now) {
  const FoldKind kind = KindOf(node.op);
  const Tick width = node.window.to - node.window.from + 1;
  const bool is_until = kind == FoldKind::kUntil;
  const std::size_t stride = is_until ? 2 * node.lanes : node.lanes;
  const bool has_value = now >= node.delay;
  if (has_value) {
    const Tick first = now - node.delay;  // its value is for this tick; value number 0 is that of tick window.from
    // Values that the window of this tick has left behind. Before the first result nothing may leave.
    while (!state.fold.empty() && state.fold.begin() < first) state.fold.Pop(kind, width, stride);
  }
  const Tick delay = InputDelay(node);
  if (HasInput(node, now) && now - delay >= node.window.from) {
    if (is_until) {
      state.scratch.resize(stride);
      Spread(node.inputs[1], values(node.inputs[1].node), std::span(state.scratch).first(node.lanes));
      Spread(node.inputs[0], values(node.inputs[0].node), std::span(state.scratch).last(node.lanes));
      state.fold.Push(kind, width, state.scratch);
    } else {
      state.fold.Push(kind, width, values(node.inputs[0].node));
    }
  }
  if (!has_value || (ended_ && now - node.delay >= ticks_)) return;
  if (state.fold.empty()) {
    // The window lies wholly beyond the end of the run: "always" holds of nothing, "eventually" does not.
    std::fill(state.values.begin(), state.values.end(), kind == FoldKind::kLeast ? kInfinity : -kInfinity);
  } else if (is_until) {
    state.scratch.resize(stride);
    state.fold.Read(kind, width, state.scratch);
    std::copy(state.scratch.begin(), state.scratch.begin() + static_cast<std::ptrdiff_t>(node.lanes),
              state.values.begin());
  } else {
    state.fold.Read(kind, width, state.values);
  }
}

void Network::Look(const Node& node, State& state, Tick now) {
  if (!HasInput(node, now)) return;
  const std::span<const double> a = values(node.inputs[0].node);
  const std::span<double> out(state.values);
  const bool is_first = now == node.delay;
  if (node.op == Op::kSince) {
    ForEachLane(node, a, values(node.inputs[1].node), [&](std::size_t i, double left, double right) {
      // The recursion of "since" needs its own value of the tick before only, no window.
      out[i] = is_first ? right : Greatest(right, Least(left, out[i]));
    });
    return;
  }
  const FoldKind kind = KindOf(node.op);
  if (node.ticks == kForever) {
    if (is_first) {
      std::copy(a.begin(), a.end(), out.begin());
    } else {
      Combine(kind, a, out);
    }
    return;
  }
  const Tick width = node.ticks + 1;
  // The window is full: the oldest value leaves before the new one comes, which needs its slot.
  if (state.fold.end() - state.fold.begin() == width) state.fold.Pop(kind, width, node.lanes);
  state.fold.Push(kind, width, a);
  state.fold.Read(kind, width, out);
}

void Network::LoadSeries(const Node& node, State& state) {
  if (node.op != Op::kPlayback && node.op != Op::kSuffixMin && node.op != Op::kSuffixMax &&
      node.op != Op::kSuffixUntil && node.op != Op::kLastValue) {
    return;
  }
  const std::size_t lanes = node.lanes;
  const auto load = [&](const NodeInput& input, std::vector<double>& series) {
    const State& source = states_[input.node];
    const std::size_t its_lanes = program_->nodes[input.node].lanes;
    // A constant's one value counts at all ticks.
    const bool is_constant = program_->nodes[input.node].op == Op::kConstant;
    series.resize(ticks_ * lanes);
    for (Tick t = 0; t < ticks_; ++t) {
      const std::span<const double> from = is_constant ? std::span<const double>(source.values)
                                                       : std::span(source.series).subspan(t * its_lanes, its_lanes);
      Spread(input, from, std::span(series).subspan(t * lanes, lanes));
    }
  };
  load(node.inputs[0], state.series);
  if (node.op == Op::kPlayback) return;
  const auto at = [&](Tick t) { return std::span(state.series).subspan(t * lanes, lanes); };
  if (node.op == Op::kSuffixUntil) {
    std::vector<double> right;
    load(node.inputs[1], right);
    // From the end to the beginning, as the recursion until(t) = max(right(t), min(left(t), until(t + 1))) needs it.
    for (Tick t = ticks_; t-- > 0;) {
      for (std::size_t i = 0; i < lanes; ++i) {
        const double enough = right[t * lanes + i];
        double& value = state.series[t * lanes + i];
        value = t + 1 == ticks_ ? enough : Greatest(enough, Least(value, state.series[(t + 1) * lanes + i]));
      }
    }
  } else {
    for (Tick t = ticks_ - 1; t-- > 0;) {
      if (node.op == Op::kLastValue) {
        std::copy(at(t + 1).begin(), at(t + 1).end(), at(t).begin());
      } else {
        Combine(node.op == Op::kSuffixMin ? FoldKind::kLeast : FoldKind::kGreatest, at(t + 1), at(t));
      }
    }
  }
  // From window.from on: the values of later ticks, and beyond the end the values of an empty window.
  const Tick from = node.window.from;
  if (from == 0) return;
  for (Tick t = 0; t < ticks_; ++t) {
    if (from < ticks_ - t) {
      std::copy(at(t + from).begin(), at(t + from).end(), at(t).begin());
    } else {
      std::fill(at(t).begin(), at(t).end(), node.op == Op::kSuffixMin ? kInfinity : -kInfinity);
    }
  }
}

void AppendThings(const MonitorProgram& program, const std::vector<std::size_t>& variables, std::size_t lane,
                  std::vector<ThingId>& things) {
  const std::size_t begin = things.size();
  for (std::size_t i = variables.size(); i-- > 0;) {
    const std::vector<ThingId>& domain = program.variables[variables[i]].things;
    things.insert(things.begin() + static_cast<std::ptrdiff_t>(begin), domain[lane % domain.size()]);
    lane /= domain.size();
  }
}

void Network::FindCause(std::size_t number, std::size_t lane, std::vector<ThingId>& things) const {
  const Node& node = program_->nodes[number];
  // Most nodes below a formula select nothing: the walk ends early.
  if (!node.names_cause) return;
  const auto lane_of = [&](const NodeInput& input) {
    if (!input.lane_of.empty()) return static_cast<std::size_t>(input.lane_of[lane]);
    return program_->nodes[input.node].lanes == 1 ? 0 : lane;
  };
  switch (node.op) {
    case Op::kSignal:
      if (states_[number].memory.pair.first == states_[number].memory.pair.second) return;  // none yet
      things.push_back(states_[number].memory.pair.first);
      things.push_back(states_[number].memory.pair.second);
      return;
    case Op::kForall:
    case Op::kExists:
    case Op::kMinimum:
    case Op::kMaximum: {
      const std::span<const double> block = values(node.inputs[0].node).subspan(lane * node.reduced, node.reduced);
      const bool is_least = node.op == Op::kForall || node.op == Op::kMinimum;
      std::optional<std::size_t> best;
      const std::size_t count = node.counted.empty() ? node.reduced : node.counted.size();
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = node.counted.empty() ? k : node.counted[k];
        // The first of equal lanes, so that a report names the same robot every time.
        if (!best || (is_least ? block[i] < block[*best] : block[i] > block[*best])) best = i;
      }
      if (!best) return;
      AppendThings(*program_, node.reduced_variables, *best, things);
      FindCause(node.inputs[0].node, lane * node.reduced + *best, things);
      return;
    }
    case Op::kAnd:
    case Op::kOr: {
      const NodeInput* best = node.inputs.data();
      for (const NodeInput& input : node.inputs) {
        const double value = values(input.node)[lane_of(input)];
        const double least = values(best->node)[lane_of(*best)];
        if (node.op == Op::kAnd ? value < least : value > least) best = &input;
      }
      FindCause(best->node, lane_of(*best), things);
      return;
    }
    case Op::kSum:
    case Op::kMean:
    case Op::kCount:
    case Op::kDelay:
    case Op::kPastShift:
    case Op::kWindowMin:
    case Op::kWindowMax:
    case Op::kUntil:
    case Op::kPastMin:
    case Op::kPastMax:
    case Op::kSince:
    case Op::kPlayback:
    case Op::kSuffixMin:
    case Op::kSuffixMax:
    case Op::kSuffixUntil:
    case Op::kLastValue:
      return;  // of several robots, or of other ticks
    default:
      for (const NodeInput& input : node.inputs) FindCause(input.node, lane_of(input), things);
  }
}

}  // namespace troupe
