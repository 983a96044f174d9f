// Expectation: a sentence about a run, in signal temporal logic, and its monitors. docs/testing.md has the language
// with a table of all signals and operators.
//
//   forall r: always (stalled(r) -> eventually[0, 10 s] not stalled(r))
//
// A monitor receives the ticks of a run one by one: of a live run, of a recording or of a branch. It is a value:
// a copy that is made with a snapshot continues with the branch. The same states give the same bits of its results.
//
// Robustness: how far a run is from the other verdict, in the unit of the comparison that decides: 0.3 for
// `always x(r) < 2 m` of a robot that came as near as 1.7 m. It is infinite where only signals that are true or false
// decide. Its sign bit is the verdict: set for false, so that -0.0 is a `<` of equal numbers, and 0.0 a `<=`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/enum_names.h"
#include "troupe/ids.h"
#include "troupe/interval.h"
#include "troupe/named_expectation.h"
#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe {

class Simulation;
struct TickView;  // testing/expectations/tick_view.h: a tick without a Simulation, for instance of a recording

// What names in expectations refer to: the robots, objects, places and sensors of a world, and regions.
struct ExpectationScope {
  const WorldDescription& world;  // valid
  std::span<const NamedRegion> regions = {};
};

// An error of a text has line 1 and the column of the first wrong byte, from 1, in `where`, all bytes of the text being
// one line: the caller knows where the text is in its file. The message names the text that was found and the expected
// one, and proposes the name that is nearest to one that does not exist.

// An expectation of one world: names are resolved and units checked. A value; copies share constant data.
class Expectation {
 public:
  static Result<Expectation> Parse(std::string_view text, const ExpectationScope& scope);

  const std::string& text() const;  // as it was written
  // The formula in the language's own spelling, with all shorthands replaced by the formulas that they stand for.
  std::string formula() const;

  struct Program;

 private:
  friend class Monitor;
  explicit Expectation(std::shared_ptr<const Program> program) : program_(std::move(program)) {}
  std::shared_ptr<const Program> program_;  // never null
};

// A number of a run: "time of first PHI", "time of last PHI", "min of EXPRESSION", "max of ...", "mean of ...",
// "final of ...", or an expression alone: its final value. Variables without a quantifier stand for all robots: "min of
// distance(a, b)".
class Metric {
 public:
  static Result<Metric> Parse(std::string_view text, const ExpectationScope& scope);

  const std::string& text() const;
  std::string formula() const;
  std::string unit() const;  // "s", "m/s", "" for a count or ratio

  struct Program;

 private:
  friend class MetricMonitor;
  explicit Metric(std::shared_ptr<const Program> program) : program_(std::move(program)) {}
  std::shared_ptr<const Program> program_;  // never null
};

enum class Verdict : std::uint8_t {
  kUndecided,  // it depends on ticks to come
  kTrue,
  kFalse,
};
constexpr auto NamesOf(Verdict) {
  return std::array{"undecided", "true", "false"};
}

// The time that a monitor needs for a tick does not depend on the lengths of intervals or of the run, on average over
// the ticks. Its memory grows with the longest interval, and with the run by a number for each tick (the history) and,
// for an operator without upper bound below another one, by a number for each robot.
class Monitor {
 public:
  explicit Monitor(const Expectation& expectation);
  Monitor(const Monitor& other);
  Monitor& operator=(const Monitor& other);
  Monitor(Monitor&& other) noexcept;
  Monitor& operator=(Monitor&& other) noexcept;
  ~Monitor();

  const Expectation& expectation() const;

  // Adds the simulation's present tick. Intervals count from the first tick added. An error, and nothing is added, for
  // a tick that is not the next one, another world, or after Finish.
  Status Push(const Simulation& simulation);
  Status Push(const TickView& tick);
  // The run has ended: decides what has been open. No future tick exists: `eventually` of none is false, `always` true.
  // REQUIRES: Push has been called
  void Finish();
  bool finished() const;

  // Decided as soon as no further tick can change it.
  Verdict verdict() const;
  // The tick after which the verdict was known; nothing while it is open.
  std::optional<Tick> decided_at() const;

  // The final robustness is within these bounds; they are equal when it is known, at the latest after Finish.
  Interval robustness_bounds() const;
  // After Finish.
  double robustness() const { return robustness_bounds().min; }

  // The robustness of the subformula of the outermost `always`, `eventually` or `until`, at one tick: the ticks at
  // which the run nearly fails. An expectation without such an operator has one entry.
  struct Moment {
    Tick tick = 0;
    double robustness = 0.0;
    bool operator==(const Moment&) const = default;
  };
  // In the order of ticks, without gaps. The last ticks may miss until Finish: what is below looks into their future.
  std::span<const Moment> history() const;

  // What decides the robustness so far: the tick, and the robots or objects that the variables of the deciding
  // quantifiers stand for.
  struct Cause {
    std::optional<Tick> tick = {};
    std::vector<std::string> names = {};  // in the order of the quantifiers, each once
    bool operator==(const Cause&) const = default;
  };
  Cause cause() const;

 private:
  struct State;
  std::unique_ptr<State> state_;  // null only after a move
};

class MetricMonitor {
 public:
  explicit MetricMonitor(const Metric& metric);
  MetricMonitor(const MetricMonitor& other);
  MetricMonitor& operator=(const MetricMonitor& other);
  MetricMonitor(MetricMonitor&& other) noexcept;
  MetricMonitor& operator=(MetricMonitor&& other) noexcept;
  ~MetricMonitor();

  const Metric& metric() const;

  Status Push(const Simulation& simulation);  // as Monitor::Push
  Status Push(const TickView& tick);
  void Finish();  // REQUIRES: Push has been called

  // After Finish, in SI units, times from tick 0; nothing if it does not exist: the time of what never happened (for
  // "time of last": to one of the robots), or a number that no tick has.
  std::optional<double> value() const;
  // Values of ticks that were no numbers, such as 0 / 0, and are left out.
  std::uint64_t undefined() const;

 private:
  struct State;
  std::unique_ptr<State> state_;  // null only after a move
};

// One row of the tables of docs/testing.md.
struct LanguageEntry {
  std::string usage;    // "at(r, PLACE[, RADIUS])"
  std::string result;   // "m", "true or false", "text", ...
  std::string meaning;  // one sentence
};
// All signals and functions; all operators; all shorthands, with the formula that each stands for.
std::vector<LanguageEntry> ListSignals();
std::vector<LanguageEntry> ListOperators();
std::vector<LanguageEntry> ListShorthands();

}  // namespace troupe
