#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "testing/expectations/compile.h"
#include "testing/expectations/network.h"
#include "testing/expectations/roots.h"
#include "testing/expectations/signals.h"
#include "troupe/expectation.h"

namespace troupe {
namespace {

// Success if the tick is the one that follows. `first`: nothing before it.
Status CheckTick(const MonitorProgram& program, const TickView& tick, std::optional<Tick> first, Tick ticks,
                 bool finished) {
  if (finished) return Error{{}, "found a tick after the end of the run, expected none"};
  // Windows count ticks: a gap would shift them without a sign.
  if (first && tick.state.tick != *first + ticks) {
    return Error{{},
                 "found tick " + std::to_string(tick.state.tick) + ", expected tick " + std::to_string(*first + ticks)};
  }
  // Ids in the program are rows of this world's tables. Tables that vary (messages, contacts) have no ids in programs.
  bool fits = tick.scene.world().interval_ns == program.interval_ns;
  for (std::size_t kind = 0; kind < StateTables().size(); ++kind) {
    const StateTable& table = StateTables()[kind];
    fits = fits && (table.varies || table.rows(tick.scene.world(), tick.state) == program.things->count(kind));
  }
  if (!fits) return Error{{}, "found a tick of another world, expected the world of the expectation"};
  return {};
}

}  // namespace

struct Expectation::Program {
  std::shared_ptr<const MonitorProgram> program;
};
struct Metric::Program {
  std::shared_ptr<const MonitorProgram> program;
};

Result<Expectation> Expectation::Parse(std::string_view text, const ExpectationScope& scope) {
  Result<MonitorProgram> program = CompileExpectation(text, scope);
  if (!program.ok()) return program.error();
  return Expectation(
      std::make_shared<const Program>(Program{std::make_shared<const MonitorProgram>(std::move(program).value())}));
}

const std::string& Expectation::text() const {
  return program_->program->text;
}

std::string Expectation::formula() const {
  return program_->program->formula;
}

Result<Metric> Metric::Parse(std::string_view text, const ExpectationScope& scope) {
  Result<MonitorProgram> program = CompileMetric(text, scope);
  if (!program.ok()) return program.error();
  return Metric(
      std::make_shared<const Program>(Program{std::make_shared<const MonitorProgram>(std::move(program).value())}));
}

const std::string& Metric::text() const {
  return program_->program->text;
}

std::string Metric::formula() const {
  return program_->program->formula;
}

std::string Metric::unit() const {
  return ToString(program_->program->dimension);
}

struct Monitor::State {
  explicit State(const Expectation& its_expectation)
      : expectation(its_expectation),
        network(its_expectation.program_->program),
        roots(*its_expectation.program_->program) {}

  void OnTick(std::size_t level, Tick now) {
    roots.Update(network, level, now);
    const std::optional<std::size_t> node = network.program().history;
    if (!node || network.program().nodes[*node].level != level || !network.IsValid(*node, now)) return;
    history.push_back({first.value_or(0) + network.TimeOf(*node, now), network.values(*node)[0]});
  }

  void Decide(Tick tick) {
    if (verdict != Verdict::kUndecided) return;
    const Interval bounds = roots.bounds();
    // Sound bounds: once both have one sign, no later tick can change it.
    if (!std::signbit(bounds.min)) verdict = Verdict::kTrue;
    if (std::signbit(bounds.max)) verdict = Verdict::kFalse;
    if (verdict != Verdict::kUndecided) decided_at = tick;
  }

  Expectation expectation;
  Network network;
  Roots roots;
  std::optional<Tick> first = {};
  bool finished = false;
  Verdict verdict = Verdict::kUndecided;
  std::optional<Tick> decided_at = {};
  std::vector<Moment> history = {};
};

Monitor::Monitor(const Expectation& expectation) : state_(std::make_unique<State>(expectation)) {}
Monitor::Monitor(const Monitor& other) : state_(std::make_unique<State>(*other.state_)) {}
Monitor& Monitor::operator=(const Monitor& other) {
  if (this != &other) state_ = std::make_unique<State>(*other.state_);
  return *this;
}
Monitor::Monitor(Monitor&& other) noexcept = default;
Monitor& Monitor::operator=(Monitor&& other) noexcept = default;
Monitor::~Monitor() = default;

const Expectation& Monitor::expectation() const {
  return state_->expectation;
}

Status Monitor::Push(const TickView& tick) {
  State& state = *state_;
  Status status = CheckTick(state.network.program(), tick, state.first, state.network.ticks(), state.finished);
  if (!status.ok()) return status;
  if (!state.first) state.first = tick.state.tick;
  state.network.Push(tick, [&](std::size_t level, Tick now) { state.OnTick(level, now); });
  state.Decide(tick.state.tick);
  return {};
}

void Monitor::Finish() {
  State& state = *state_;
  TROUPE_CHECK(state.first.has_value());
  if (state.finished) return;
  state.finished = true;
  state.network.Finish([&](std::size_t level, Tick now) { state.OnTick(level, now); });
  state.roots.Finish(state.network);
  // What is decided by the end of the run is decided at its last tick.
  state.Decide(*state.first + state.network.ticks() - 1);
  // A formula without time has one moment: its value at the first tick.
  if (!state.network.program().history) state.history.push_back({*state.first, state.roots.bounds().min});
}

bool Monitor::finished() const {
  return state_->finished;
}

Verdict Monitor::verdict() const {
  return state_->verdict;
}

std::optional<Tick> Monitor::decided_at() const {
  return state_->decided_at;
}

Interval Monitor::robustness_bounds() const {
  return state_->roots.bounds();
}

std::span<const Monitor::Moment> Monitor::history() const {
  return state_->history;
}

Monitor::Cause Monitor::cause() const {
  const MonitorProgram& program = state_->network.program();
  Cause cause;
  if (!state_->first) return cause;
  Roots::Cause found = state_->roots.FindCause(program);
  if (found.tick) cause.tick = *state_->first + *found.tick;
  for (const ThingId thing : found.things) {
    const std::string& name = program.things->name(thing);
    if (std::find(cause.names.begin(), cause.names.end(), name) == cause.names.end()) cause.names.push_back(name);
  }
  return cause;
}

struct MetricMonitor::State {
  explicit State(const Metric& its_metric) : metric(its_metric), network(its_metric.program_->program) {}

  void OnTick(std::size_t level, Tick now) {
    const MonitorProgram& program = network.program();
    const std::size_t node = program.value;
    if (program.nodes[node].level != level || !network.IsValid(node, now)) return;
    const std::span<const double> values = network.values(node);
    const Tick tick = first.value_or(0) + network.TimeOf(node, now);
    const bool is_time = program.metric == MetricKind::kFirst || program.metric == MetricKind::kLast;
    if (held.empty()) {
      held.assign(values.size(), false);
      begun.assign(values.size(), false);
    }
    if (program.metric == MetricKind::kFinal) count = 0.0;
    const auto add = [&](std::size_t lane) {
      const double value = values[lane];
      if (!is_time && std::isnan(value)) {
        ++undefined;
        return;
      }
      const bool holds = !std::signbit(value);
      switch (program.metric) {
        case MetricKind::kFirst:
        case MetricKind::kLast:
          // A time is the tick at which the condition begins to hold, of any lane; later ticks of the same spell do not
          // count.
          if (holds && !held[lane] && (program.metric == MetricKind::kLast || count == 0.0)) {
            result = static_cast<double>(tick) * static_cast<double>(program.interval_ns) / 1e9;
            count += 1.0;
          }
          held[lane] = holds;
          begun[lane] = begun[lane] || holds;
          break;
        case MetricKind::kMin:
          result = count == 0.0 || value < result ? value : result;
          break;
        case MetricKind::kMax:
          result = count == 0.0 || value > result ? value : result;
          break;
        case MetricKind::kMean:
          result += value;
          break;
        case MetricKind::kFinal:
          result = value;
          break;
      }
      if (!is_time) count += 1.0;
    };
    ForEachLane(values.size(), add);
  }

  template <typename Visit>
  void ForEachLane(std::size_t lanes, const Visit& visit) const {
    const std::vector<std::uint32_t>& counted = network.program().counted;
    if (counted.empty()) {
      for (std::size_t lane = 0; lane < lanes; ++lane) visit(lane);
    } else if (counted[0] != SignalUse::kNone) {
      for (const std::uint32_t lane : counted) visit(lane);
    }
  }

  Metric metric;
  Network network;
  std::optional<Tick> first = {};
  bool finished = false;
  std::vector<bool> held = {};   // by lane, of "time of": at the last tick
  std::vector<bool> begun = {};  // and at any tick so far
  std::uint64_t undefined = 0;   // values that are no numbers
  double result = 0.0;
  double count = 0.0;  // of the values in it
};

MetricMonitor::MetricMonitor(const Metric& metric) : state_(std::make_unique<State>(metric)) {}
MetricMonitor::MetricMonitor(const MetricMonitor& other) : state_(std::make_unique<State>(*other.state_)) {}
MetricMonitor& MetricMonitor::operator=(const MetricMonitor& other) {
  if (this != &other) state_ = std::make_unique<State>(*other.state_);
  return *this;
}
MetricMonitor::MetricMonitor(MetricMonitor&& other) noexcept = default;
MetricMonitor& MetricMonitor::operator=(MetricMonitor&& other) noexcept = default;
MetricMonitor::~MetricMonitor() = default;

const Metric& MetricMonitor::metric() const {
  return state_->metric;
}

Status MetricMonitor::Push(const TickView& tick) {
  State& state = *state_;
  Status status = CheckTick(state.network.program(), tick, state.first, state.network.ticks(), state.finished);
  if (!status.ok()) return status;
  if (!state.first) state.first = tick.state.tick;
  state.network.Push(tick, [&](std::size_t level, Tick now) { state.OnTick(level, now); });
  return {};
}

void MetricMonitor::Finish() {
  State& state = *state_;
  TROUPE_CHECK(state.first.has_value());
  if (state.finished) return;
  state.finished = true;
  state.network.Finish([&](std::size_t level, Tick now) { state.OnTick(level, now); });
}

std::optional<double> MetricMonitor::value() const {
  const State& state = *state_;
  if (!state.finished || state.count == 0.0) return std::nullopt;
  const MetricKind kind = state.network.program().metric;
  bool is_whole = true;
  // The last arrival does not exist while one robot has not arrived: that of the others would look better than it is.
  if (kind == MetricKind::kLast) {
    state.ForEachLane(state.begun.size(), [&](std::size_t lane) { is_whole = is_whole && state.begun[lane]; });
  }
  if (!is_whole) return std::nullopt;
  return kind == MetricKind::kMean ? state.result / state.count : state.result;
}

std::uint64_t MetricMonitor::undefined() const {
  return state_->undefined;
}

}  // namespace troupe
