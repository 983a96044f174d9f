// GoogleTest matchers for runs: a test of a fleet in a few lines. Needs GoogleMock in the including program.
//
//   Simulation simulation = Simulation::Load("warehouse.json").value();
//   EXPECT_THAT(Watch(simulation, 600, "no_contact"), Satisfied());
//   EXPECT_THAT(Watch(simulation, 600, "always speed(anna) < 1 m/s"), HasRobustness(testing::Gt(0.1)));
#pragma once

#include <gmock/gmock.h>

#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "troupe/expectation.h"
#include "troupe/simulation.h"

namespace troupe {

// For the output of a failed test: the formula, the verdict, the tick and the robots that decide it.
inline void PrintTo(const Monitor& monitor, std::ostream* out) {
  *out << "\"" << monitor.expectation().formula() << "\", which is " << NameOf(monitor.verdict());
  if (const std::optional<Tick> tick = monitor.decided_at()) *out << " since tick " << *tick;
  const Interval bounds = monitor.robustness_bounds();
  *out << ", robustness " << bounds.min;
  if (bounds.min != bounds.max) *out << " to " << bounds.max;
  const Monitor::Cause cause = monitor.cause();
  if (cause.tick) *out << ", decided by tick " << *cause.tick;
  for (std::size_t i = 0; i < cause.names.size(); ++i) *out << (i == 0 ? " of " : " and ") << cause.names[i];
}

// Steps the simulation by `ticks` and returns finished monitors of the expectations, in their order: from the present
// tick to the last one. The error is that of an expectation, with its text.
inline Result<std::vector<Monitor>> WatchAll(Simulation& simulation, Tick ticks,
                                             const std::vector<std::string>& expectations,
                                             std::span<const NamedRegion> regions = {}) {
  std::vector<Monitor> monitors;
  for (const std::string& text : expectations) {
    Result<Expectation> expectation = Expectation::Parse(text, {simulation.world(), regions});
    if (!expectation.ok()) {
      Error error = expectation.error();
      error.message += ", in: " + text;
      return error;
    }
    monitors.emplace_back(expectation.value());
  }
  for (Tick i = 0; i <= ticks; ++i) {
    if (i > 0) simulation.Step();
    for (Monitor& monitor : monitors) {
      if (Status problem = monitor.Push(simulation); !problem.ok()) return problem.error();
    }
  }
  for (Monitor& monitor : monitors) monitor.Finish();
  return monitors;
}

// The same for one expectation.
inline Result<Monitor> Watch(Simulation& simulation, Tick ticks, const std::string& expectation,
                             std::span<const NamedRegion> regions = {}) {
  Result<std::vector<Monitor>> monitors = WatchAll(simulation, ticks, {expectation}, regions);
  if (!monitors.ok()) return monitors.error();
  return std::move(monitors.value().front());
}

// For the output of a failed test.
inline void PrintTo(const Result<Monitor>& result, std::ostream* out) {
  if (result.ok()) {
    PrintTo(result.value(), out);
  } else {
    *out << result.error().ToString();
  }
}

namespace testing_internal {

// A matcher of a Monitor, or of what Watch returns.
class RobustnessMatcher {
 public:
  using is_gtest_matcher = void;
  explicit RobustnessMatcher(::testing::Matcher<double> inner) : inner_(std::move(inner)) {}

  bool MatchAndExplain(const Monitor& monitor, std::ostream*) const { return inner_.Matches(monitor.robustness()); }
  bool MatchAndExplain(const Result<Monitor>& result, std::ostream* out) const {
    return result.ok() && MatchAndExplain(result.value(), out);
  }
  void DescribeTo(std::ostream* out) const {
    *out << "has a robustness that ";
    inner_.DescribeTo(out);
  }
  void DescribeNegationTo(std::ostream* out) const {
    *out << "has a robustness that ";
    inner_.DescribeNegationTo(out);
  }

 private:
  ::testing::Matcher<double> inner_;
};

class VerdictMatcher {
 public:
  using is_gtest_matcher = void;
  explicit VerdictMatcher(Verdict verdict) : verdict_(verdict) {}

  bool MatchAndExplain(const Monitor& monitor, std::ostream*) const { return monitor.verdict() == verdict_; }
  bool MatchAndExplain(const Result<Monitor>& result, std::ostream* out) const {
    return result.ok() && MatchAndExplain(result.value(), out);
  }
  void DescribeTo(std::ostream* out) const { *out << "is an expectation that is " << NameOf(verdict_); }
  void DescribeNegationTo(std::ostream* out) const { *out << "is no expectation that is " << NameOf(verdict_); }

 private:
  Verdict verdict_;
};

}  // namespace testing_internal

// The expectation has come true.
inline testing_internal::VerdictMatcher Satisfied() {
  return testing_internal::VerdictMatcher(Verdict::kTrue);
}
// The expectation has become false.
inline testing_internal::VerdictMatcher Violated() {
  return testing_internal::VerdictMatcher(Verdict::kFalse);
}
// HasRobustness(testing::Gt(0.1)): by a margin. Of a finished monitor.
template <typename Inner>
testing_internal::RobustnessMatcher HasRobustness(Inner inner) {
  return testing_internal::RobustnessMatcher(::testing::SafeMatcherCast<double>(inner));
}

}  // namespace troupe
