// Random formulas over random runs: monitors against an evaluator that follows the definitions word by word.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "testing/expectations/rewrite.h"
#include "testing/expectations/syntax.h"
#include "testing/expectations/tick_view.h"
#include "tests/support/small_world.h"
#include "troupe/expectation.h"

namespace troupe {
namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();
constexpr int kRobots = 3;

WorldDescription ThreeRobots() {
  SmallWorld world;
  for (int i = 0; i < kRobots; ++i) world.AddRobot("r" + std::to_string(i), {1.0 * i, 0.0, 0.0, 0.0});
  return world.world();
}

bool IsFalse(double robustness) {
  return std::signbit(robustness);
}
double Lesser(double a, double b) {
  return a < b || (a == b && IsFalse(a)) ? a : b;
}
double Greater(double a, double b) {
  return -Lesser(-a, -b);
}

// The definitions of docs/testing.md, with a loop for each quantifier and operator.
class NaiveEvaluator {
 public:
  explicit NaiveEvaluator(const std::vector<WorldState>& run) : run_(run), last_(static_cast<int>(run.size()) - 1) {}

  double Truth(const Syntax& f, int t) {
    if (f.kind == SyntaxKind::kName) return f.name == "true" ? kNothing : -kNothing;
    if (f.kind == SyntaxKind::kCall) return Robot(f, t).stalled ? kNothing : -kNothing;
    if (f.kind == SyntaxKind::kBound) {
      const bool all = f.name == "forall";
      double result = all ? kNothing : -kNothing;
      ForEachBinding(f, 0, [&] {
        const double value = Truth(f.children[0], t);
        result = all ? Lesser(result, value) : Greater(result, value);
      });
      return result;
    }
    if (f.kind == SyntaxKind::kTemporal) return Temporal(f, t);
    if (f.name == "not") return -Truth(f.children[0], t);
    if (f.name == "->") return Greater(-Truth(f.children[0], t), Truth(f.children[1], t));
    if (f.name == "and" || f.name == "or") {
      double result = Truth(f.children[0], t);
      for (const Syntax& child : f.children) {
        result = f.name == "and" ? Lesser(result, Truth(child, t)) : Greater(result, Truth(child, t));
      }
      return result;
    }
    const double a = Number(f.children[0], t);
    const double b = Number(f.children[1], t);
    if (f.name == ">") return a == b ? -0.0 : a - b;
    if (f.name == ">=") return a == b ? 0.0 : a - b;
    if (f.name == "<") return a == b ? -0.0 : b - a;
    if (f.name == "<=") return a == b ? 0.0 : b - a;
    if (f.name == "==") return a == b ? 0.0 : -std::abs(a - b);
    return a == b ? -0.0 : std::abs(a - b);
  }

 private:
  const RobotState& Robot(const Syntax& call, int t) {
    return run_[static_cast<std::size_t>(t)].robots[bindings_.at(call.children[0].name)];
  }

  template <typename Visit>
  void ForEachBinding(const Syntax& f, std::size_t next, const Visit& visit) {
    if (next == f.variables.size()) return visit();
    for (std::size_t robot = 0; robot < kRobots; ++robot) {
      bool used = false;
      for (std::size_t i = 0; i < next; ++i) used = used || bindings_[f.variables[i]] == robot;
      if (used || (f.pattern && !Matches(*f.pattern, "r" + std::to_string(robot)))) continue;
      bindings_[f.variables[next]] = robot;
      ForEachBinding(f, next + 1, visit);
    }
  }

  // * is any characters, ? one.
  static bool Matches(std::string_view pattern, std::string_view name) {
    if (pattern.empty()) return name.empty();
    if (pattern[0] == '*')
      return Matches(pattern.substr(1), name) || (!name.empty() && Matches(pattern, name.substr(1)));
    return !name.empty() && (pattern[0] == '?' || pattern[0] == name[0]) && Matches(pattern.substr(1), name.substr(1));
  }

  double Number(const Syntax& f, int t) {
    if (f.kind == SyntaxKind::kNumber) return f.number.value;
    if (f.kind == SyntaxKind::kCall && f.name == "x") return Robot(f, t).X_WR.x;
    if (f.kind == SyntaxKind::kCall && f.name == "y") return Robot(f, t).X_WR.y;
    if (f.kind == SyntaxKind::kCall && f.name == "sqrt") return std::sqrt(Number(f.children[0], t));
    if (f.kind == SyntaxKind::kCall && f.name == "abs") return std::abs(Number(f.children[0], t));
    if (f.kind == SyntaxKind::kCall) {
      const double a = Number(f.children[0], t);
      const double b = Number(f.children[1], t);
      return f.name == "min" ? std::min(a, b) : std::max(a, b);
    }
    if (f.kind == SyntaxKind::kBound) {
      double result = f.name == "min" ? kNothing : f.name == "max" ? -kNothing : 0.0;
      int count = 0;
      ForEachBinding(f, 0, [&] {
        ++count;
        if (f.name == "count") {
          result += IsFalse(Truth(f.children[0], t)) ? 0.0 : 1.0;
          return;
        }
        const double value = Number(f.children[0], t);
        result = f.name == "min" ? std::min(result, value) : f.name == "max" ? std::max(result, value) : result + value;
      });
      return f.name == "mean" ? result / count : result;
    }
    if (f.children.size() == 1) return -Number(f.children[0], t);
    const double a = Number(f.children[0], t);
    const double b = Number(f.children[1], t);
    return f.name == "+" ? a + b : f.name == "-" ? a - b : f.name == "*" ? a * b : a / b;
  }

  double Temporal(const Syntax& f, int t) {
    const int from = f.interval ? static_cast<int>(f.interval->from.value) : 0;
    const int to = f.interval && f.interval->to ? static_cast<int>(f.interval->to->value) : 1000;
    double result = f.name == "always" || f.name == "historically" ? kNothing : -kNothing;
    if (f.name == "finally") return Truth(f.children[0], last_);
    if (f.name == "since") {
      for (int s = t; s >= 0; --s) {
        double value = Truth(f.children[1], s);
        for (int u = s + 1; u <= t; ++u) value = Lesser(value, Truth(f.children[0], u));
        result = Greater(result, value);
      }
      return result;
    }
    if (f.name == "until") {
      for (int s = t + from; s <= std::min(t + to, last_); ++s) {
        double value = Truth(f.children[1], s);
        for (int u = t; u < s; ++u) value = Lesser(value, Truth(f.children[0], u));
        result = Greater(result, value);
      }
      return result;
    }
    const bool past = f.name == "historically" || f.name == "once";
    const bool all = f.name == "always" || f.name == "historically";
    const int begin = past ? std::max(t - to, 0) : t + from;
    const int end = past ? t - from : std::min(t + to, last_);
    for (int s = begin; s <= end; ++s) {
      const double value = Truth(f.children[0], s);
      result = all ? Lesser(result, value) : Greater(result, value);
    }
    return result;
  }

  const std::vector<WorldState>& run_;
  int last_;
  std::map<std::string, std::size_t> bindings_;
};

class RandomFormula {
 public:
  explicit RandomFormula(std::uint32_t seed) : random_(seed) {}

  int Below(int count) { return static_cast<int>(random_() % static_cast<std::uint32_t>(count)); }

  std::string Truth(int depth, const std::vector<std::string>& variables) {
    if (variables.empty() || (depth > 1 && variables.size() < 3 && Below(4) == 0)) return Quantified(depth, variables);
    if (depth <= 0) return Atom(variables);
    switch (Below(11)) {
      case 0:
        return "not (" + Truth(depth - 1, variables) + ")";
      case 1:
        return Joined(depth, variables, "and");
      case 2:
        return Joined(depth, variables, "or");
      case 3:
        return Joined(depth, variables, "->");
      case 4:
        return "always" + Interval(true) + " (" + Truth(depth - 1, variables) + ")";
      case 5:
        return "eventually" + Interval(true) + " (" + Truth(depth - 1, variables) + ")";
      case 6:
        return Joined(depth, variables, "until" + Interval(true));
      case 7:
        return Joined(depth, variables, "since");
      case 8:
        return "historically" + Interval(true) + " (" + Truth(depth - 1, variables) + ")";
      case 9:
        return "once" + Interval(true) + " (" + Truth(depth - 1, variables) + ")";
      default:
        return Below(3) == 0 ? "finally (" + Truth(depth - 1, variables) + ")" : Atom(variables);
    }
  }

 private:
  std::string Interval(bool may_be_missing) {
    if (may_be_missing && Below(3) == 0) return "";
    const int from = Below(4);
    if (Below(5) == 0) return "[" + std::to_string(from) + " ticks, end]";
    return "[" + std::to_string(from) + " ticks, " + std::to_string(from + Below(5)) + " ticks]";
  }

  std::string Joined(int depth, const std::vector<std::string>& variables, const std::string& with) {
    return "(" + Truth(depth - 1, variables) + ") " + with + " (" + Truth(depth - 1, variables) + ")";
  }

  // The body mentions each variable, as it must.
  std::string Quantified(int depth, std::vector<std::string> variables) {
    std::vector<std::string> names{"v" + std::to_string(variables.size())};
    if (Below(3) == 0) names.push_back("w" + std::to_string(variables.size()));
    variables.insert(variables.end(), names.begin(), names.end());
    std::string text = Below(2) == 0 ? "forall " : "exists ";
    for (std::size_t i = 0; i < names.size(); ++i) text += (i > 0 ? ", " : "") + names[i];
    if (names.size() == 1 && Below(4) == 0) text += Pattern();
    text += ": (" + Truth(depth - 1, variables) + ")";
    for (const std::string& name : names) text += (Below(2) == 0 ? " and (" : " or (") + Atom({name}) + ")";
    return "(" + text + ")";
  }

  std::string Number(const std::vector<std::string>& variables) {
    const std::string& variable = variables[static_cast<std::size_t>(Below(static_cast<int>(variables.size())))];
    switch (Below(12)) {
      case 0:
        return "x(" + variable + ") - y(" + variable + ")";
      case 1:
        return "abs(y(" + variable + "))";
      case 2:
        return "(min q: x(q) + y(" + variable + "))";
      case 3:
        return "2 * x(" + variable + ")";
      case 4:
        return "(max q: y(q) - x(" + variable + "))";
      case 5:
        return "(sum q: x(q) - y(" + variable + ")) / 2";
      case 6:
        return "(mean q" + Pattern() + ": x(q) + y(" + variable + "))";
      case 7:
        return "sqrt(x(" + variable + ") * x(" + variable + ") + y(" + variable + ") * y(" + variable + "))";
      case 8:
        return std::string(Below(2) == 0 ? "min" : "max") + "(x(" + variable + "), -y(" + variable + "))";
      default:
        return (Below(2) == 0 ? "x(" : "y(") + variable + ")";
    }
  }

  // Of one robot or of all.
  std::string Pattern() {
    const char* const patterns[] = {"r1*", "?2", "*"};
    return std::string(" in \"") + patterns[Below(3)] + "\"";
  }

  std::string Atom(const std::vector<std::string>& variables) {
    const std::string& variable = variables[static_cast<std::size_t>(Below(static_cast<int>(variables.size())))];
    if (Below(4) == 0) return "stalled(" + variable + ")";
    if (Below(8) == 0) return "(count q: x(q) > x(" + variable + ")) >= " + std::to_string(Below(3));
    const char* const comparisons[] = {"<", "<=", ">", ">=", "==", "!="};
    return Number(variables) + " " + comparisons[Below(6)] + " " + std::to_string(Below(4));
  }

  std::mt19937 random_;
};

std::vector<WorldState> RandomRun(const WorldDescription& world, RandomFormula& random) {
  std::vector<WorldState> run;
  const int ticks = 1 + random.Below(14);
  for (int t = 0; t < ticks; ++t) {
    WorldState state = PlacedState(world);
    state.tick = static_cast<Tick>(t);
    for (RobotState& robot : state.robots) {
      robot.X_WR.x = random.Below(7) - 3;  // whole numbers: equal ones are frequent
      robot.X_WR.y = random.Below(7) - 3;
      robot.stalled = random.Below(2) == 0;
    }
    run.push_back(state);
  }
  return run;
}

void ExpectSame(double found, double expected) {
  EXPECT_EQ(found, expected);
  EXPECT_EQ(std::signbit(found), std::signbit(expected));
}

TEST(ExpectationPropertyTest, RobustnessHasTheValueAndSignOfTheDefinitions) {
  const WorldDescription world = ThreeRobots();
  const Scene scene(world);
  int decided_early = 0;
  for (std::uint32_t seed = 0; seed < 4000 && !HasFailure(); ++seed) {
    RandomFormula random(seed);
    const std::string text = random.Truth(1 + random.Below(4), {});
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + text);
    const Result<Expectation> expectation = Expectation::Parse(text, {world});
    ASSERT_TRUE(expectation.ok()) << expectation.error().ToString();
    const Result<Syntax> syntax = ParseFormula(text);
    ASSERT_TRUE(syntax.ok());
    // What is printed is the same formula.
    ASSERT_EQ(ToString(ParseFormula(expectation.value().formula()).value()), expectation.value().formula());
    const std::vector<WorldState> run = RandomRun(world, random);

    Monitor monitor(expectation.value());
    std::optional<Monitor> branch;  // a copy from any tick continues like the first one
    Interval bounds{-kNothing, kNothing};
    BodyIndex bodies(scene);
    for (const WorldState& state : run) {
      bodies.Assign(state);
      const TickView view{scene, bodies, state, {}};
      ASSERT_TRUE(monitor.Push(view).ok());
      if (branch) {
        ASSERT_TRUE(branch->Push(view).ok());
      }
      if (!branch && random.Below(3) == 0) branch = monitor;
      const Interval next = monitor.robustness_bounds();
      EXPECT_GE(next.min, bounds.min);
      EXPECT_LE(next.max, bounds.max);
      bounds = next;
    }
    const Verdict before_end = monitor.verdict();
    monitor.Finish();
    NaiveEvaluator naive(run);
    const double expected = naive.Truth(syntax.value(), 0);
    ExpectSame(monitor.robustness(), expected);
    ExpectSame(naive.Truth(ParseFormula(expectation.value().formula()).value(), 0), expected);
    EXPECT_GE(expected, bounds.min);
    EXPECT_LE(expected, bounds.max);
    EXPECT_EQ(monitor.verdict(), IsFalse(expected) ? Verdict::kFalse : Verdict::kTrue);
    if (before_end != Verdict::kUndecided) {
      ++decided_early;
      EXPECT_EQ(before_end, monitor.verdict());
    }
    if (branch) {
      branch->Finish();
      ExpectSame(branch->robustness(), expected);
      EXPECT_EQ(branch->verdict(), monitor.verdict());
      EXPECT_TRUE(std::equal(branch->history().begin(), branch->history().end(), monitor.history().begin(),
                             monitor.history().end()));
      EXPECT_EQ(branch->cause(), monitor.cause());
    }
    ASSERT_FALSE(monitor.history().empty());
  }
  EXPECT_GT(decided_early, 500);  // verdicts do not wait for the end of the run
}

TEST(ExpectationPropertyTest, ClosestPairsAreThoseOfAllPairs) {
  SmallWorld small;
  for (int i = 0; i < 9; ++i) small.AddRobot("r" + std::to_string(i), {1.0 * i, 0.0, 0.0, 0.0});
  const WorldDescription& world = small.world();
  const Scene scene(world);
  // The second form is not one that is read for all pairs at once.
  Monitor quick(Expectation::Parse("always forall a, b: distance(a, b) > 0.1 m", {world}).value());
  Monitor slow(Expectation::Parse("always forall a, b: distance(a, b) - 0.1 m + 0 * x(a) > 0 m", {world}).value());
  RandomFormula random(7);
  BodyIndex bodies(scene);
  for (Tick t = 0; t < 200; ++t) {
    WorldState state = PlacedState(world);
    state.tick = t;
    for (std::size_t i = 0; i < state.robots.size(); ++i) {  // each in a field of its own: no two distances are equal
      const double column = static_cast<double>(i % 3);
      const double row = static_cast<double>(i / 3);
      state.robots[i].X_WR = {2.0 * column + 0.01 * random.Below(120), 2.0 * row + 0.01 * random.Below(120), 0.0,
                              0.1 * random.Below(31)};
    }
    bodies.Assign(state);
    ASSERT_TRUE(quick.Push(TickView{scene, bodies, state, {}}).ok());
    ASSERT_TRUE(slow.Push(TickView{scene, bodies, state, {}}).ok());
    ASSERT_EQ(quick.history().size(), t + 1);
    EXPECT_NEAR(quick.history()[t].robustness, slow.history()[t].robustness, 1e-12) << t;
    std::vector<std::string> names = slow.cause().names;  // either order of the two
    std::sort(names.begin(), names.end());
    EXPECT_EQ(quick.cause().names, names) << t;
  }
}

}  // namespace
}  // namespace troupe
