// Monitors of whole simulations: verdicts, the ticks at which they are known, causes, metrics, branches, and the
// examples of the documentation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "testing/expectations/tick_view.h"
#include "tests/support/small_world.h"
#include "troupe/expectation.h"
#include "troupe/simulation.h"
#include "troupe/testing.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::Not;

// anna drives 0.5 m/s towards a wall 2.5 m in front of her front, which she meets after 4.6 s; bob stands behind her.
class MonitorTest : public ::testing::Test {
 protected:
  MonitorTest() {
    const RobotId anna = world_.AddRobot("anna", {});
    world_.AddRanger(anna, {}, {OneRay()});
    world_.SetController(anna, "script", R"({"commands": [{"at": 0, "vx": 0.5}]})");
    world_.AddRobot("bob", {-1.0, 0.0, 0.0, 0.0});
    world_.AddBox("wall", 3.0, 0.0, 1.0, 9.0, {0.0, 1.0});
    world_.world().places.push_back({"dock", {}, {}, {1.0, 0.0, 0.0, 0.0}});
  }

  Simulation Start() { return Simulation::Create(world_.world()).value(); }

  Monitor Run(const std::string& text, Tick ticks) {
    Simulation simulation = Start();
    Result<Monitor> monitor = Watch(simulation, ticks, text, std::span(&yard_, 1));
    if (!monitor.ok()) ADD_FAILURE() << monitor.error().ToString();
    return std::move(monitor).value();
  }

  std::optional<double> Measure(const std::string& text, Tick ticks) {
    Simulation simulation = Start();
    MetricMonitor monitor(Metric::Parse(text, {simulation.world()}).value());
    for (Tick i = 0; i <= ticks; ++i) {
      if (i > 0) simulation.Step();
      EXPECT_TRUE(monitor.Push(simulation).ok());
    }
    monitor.Finish();
    return monitor.value();
  }

  SmallWorld world_;
  NamedRegion yard_{"yard", {{-2.0, -1.0}, {2.0, -1.0}, {2.0, 1.0}, {-2.0, 1.0}}};
};

TEST_F(MonitorTest, AFalseVerdictNamesTheTickAndTheRobot) {
  const Monitor monitor = Run("forall r: always not stalled(r)", 60);
  EXPECT_EQ(monitor.verdict(), Verdict::kFalse);
  EXPECT_EQ(monitor.robustness(), -std::numeric_limits<double>::infinity());
  EXPECT_THAT(monitor.cause().names, ElementsAre("anna"));
  EXPECT_EQ(monitor.cause().tick, monitor.decided_at());
  ASSERT_EQ(monitor.history().size(), 61u);
  EXPECT_EQ(monitor.history()[*monitor.cause().tick].robustness, monitor.robustness());
}

TEST_F(MonitorTest, RobustnessIsTheDistanceFromTheOtherVerdict) {
  const Monitor monitor = Run("forall r: always x(r) < 2 m", 20);
  EXPECT_EQ(monitor.verdict(), Verdict::kTrue);
  EXPECT_EQ(monitor.decided_at(), 20u);  // nothing but the end of the run decides it
  EXPECT_NEAR(monitor.robustness(), 1.0, 1e-9);
  EXPECT_THAT(monitor.cause().names, ElementsAre("anna"));
  EXPECT_EQ(monitor.cause().tick, 20u);
  ASSERT_EQ(monitor.history().size(), 21u);
  EXPECT_NEAR(monitor.history()[10].robustness, 1.5, 1e-9);
}

TEST_F(MonitorTest, VerdictsAreKnownAsSoonAsNothingCanChangeThem) {
  EXPECT_EQ(Run("eventually x(anna) > 0.99 m", 40).decided_at(), 20u);
  EXPECT_EQ(Run("eventually[0, 1 s] x(anna) > 0.99 m", 40).decided_at(), 10u);
  EXPECT_EQ(Run("always[0, 1 s] x(anna) < 0.99 m", 40).decided_at(), 10u);
  EXPECT_EQ(Run("x(anna) > 1 m", 40).decided_at(), 0u);
  EXPECT_EQ(Run("always (x(anna) > 0.99 m -> eventually[0, 1 s] x(anna) < 0.5 m)", 60).decided_at(), 30u);
  EXPECT_EQ(Run("not stalled(anna) until x(anna) > 0.99 m", 40).decided_at(), 20u);
  EXPECT_EQ(Run("forall r: eventually at(r, dock)", 40).verdict(), Verdict::kFalse);
  EXPECT_THAT(Run("forall r: eventually at(r, dock)", 40).cause().names, ElementsAre("bob"));
  EXPECT_EQ(Run("exists r: eventually at(r, dock, 22 cm)", 40).decided_at(), 16u);  // at 0.8 m
}

TEST_F(MonitorTest, PlacesAndRegionsOfABuildingAreOnTheirLevel) {
  WorldDescription& world = world_.world();
  world.places.push_back({"above", {}, {}, {1.0, 0.0, 2.6, 0.0}});
  world.places.push_back({"stand", {}, {}, {1.0, 0.0, 0.8, 0.0}});
  // Without levels a height means nothing.
  EXPECT_EQ(Run("eventually at(anna, above)", 40).verdict(), Verdict::kTrue);
  world.levels = {{"L1", 0.0}, {"L2", 3.0}};
  EXPECT_EQ(Run("eventually at(anna, dock)", 40).verdict(), Verdict::kTrue);
  EXPECT_EQ(Run("eventually at(anna, stand)", 40).verdict(), Verdict::kTrue) << "nearer to L1";
  const Monitor above = Run("eventually at(anna, above, 5 m)", 40);
  EXPECT_EQ(above.verdict(), Verdict::kFalse);
  EXPECT_EQ(above.robustness(), -3.0) << "the levels are so far apart";
  EXPECT_EQ(Run("exists r: eventually at(r, above)", 40).verdict(), Verdict::kFalse);
  EXPECT_EQ(Run("reached(above, 10 s, 1 m)", 40).verdict(), Verdict::kFalse);
  EXPECT_EQ(Measure("time of first at(anna, above)", 40), std::nullopt);
  EXPECT_EQ(Measure("min of distance(anna, above)", 40), std::numeric_limits<double>::infinity());
  EXPECT_EQ(Measure("min of distance(anna, dock)", 40), 0.0);
  EXPECT_EQ(Run("always in(bob, yard)", 2).verdict(), Verdict::kTrue) << "a flat region is on all levels";
  yard_.z = 2.9;
  EXPECT_EQ(Run("eventually in(bob, yard)", 2).robustness(), -3.0);
  EXPECT_EQ(Run("within(yard)", 2).verdict(), Verdict::kFalse);
  yard_.z = 0.0;
  EXPECT_EQ(Run("always in(bob, yard)", 2).verdict(), Verdict::kTrue);
}

TEST_F(MonitorTest, UntilIsDecidedByOneSideWhereTheOtherIsKnownLater) {
  struct Case {
    const char* text;
    Tick decided_at;
    Verdict verdict;
    std::optional<Tick> cause = {};  // of a false one
  };
  for (const Case& each : {
           Case{"(always[0, 1 s] x(anna) < 100 m) until speed(anna) >= 0 m/s", 0, Verdict::kTrue},
           Case{"(always x(anna) < 100 m) until speed(anna) >= 0 m/s", 0, Verdict::kTrue},
           Case{"not ((always x(anna) < 100 m) until speed(anna) >= 0 m/s)", 0, Verdict::kFalse},
           Case{"forall r: (always x(r) < 100 m) until speed(r) >= 0 m/s", 0, Verdict::kTrue},
           // No right side in its interval.
           Case{"(always x(anna) < 100 m) until[0, 1 s] x(anna) < -1 m", 10, Verdict::kFalse, 0},
           Case{"(always x(anna) < 100 m) until[0.5 s, 1 s] x(anna) < -1 m", 10, Verdict::kFalse, 5},
           // No left side before it; at the end of the run it is farthest from it at the last tick before the interval.
           Case{"x(anna) < 0.49 m until[2 s, 3 s] (always x(anna) < 100 m)", 10, Verdict::kFalse, 19},
           // What one side leaves open takes as long as the other.
           Case{"(always[0, 1 s] x(anna) < 100 m) until x(anna) > 0.49 m", 20, Verdict::kTrue},
           Case{"(always x(anna) < 100 m) until x(anna) > 0.49 m", 40, Verdict::kTrue},
       }) {
    const Monitor monitor = Run(each.text, 40);
    EXPECT_EQ(monitor.verdict(), each.verdict) << each.text;
    EXPECT_EQ(monitor.decided_at(), each.decided_at) << each.text;
    if (each.cause) {
      EXPECT_EQ(monitor.cause().tick, each.cause) << each.text;
    }
    EXPECT_EQ(monitor.history().size(), 41u) << each.text;
  }
}

TEST_F(MonitorTest, PeopleAreMeasured) {
  EXPECT_EQ(Measure("min of person_distance(anna)", 5), std::numeric_limits<double>::infinity());
  // One who stands beside anna's way, 0.55 m from her side as she passes.
  WorldDescription& world = world_.world();
  world.goal_sets.resize(1);
  world.shapes.push_back({{{{{-0.25, -0.25}, {0.25, -0.25}, {0.25, 0.25}, {-0.25, 0.25}}, {0.0, 1.75}}}, {}, {}});
  world.models.emplace_back();
  world.models.back().name = "guest";
  world.models.back().shape = ShapeId(world.shapes.size() - 1);
  world.models.back().X_PM = {1.0, 1.0, 0.0, 0.0};
  world.people.push_back({.root = ModelId(world.models.size() - 1), .reaction = PersonReaction::kCareless});
  EXPECT_NEAR(*Measure("min of person_distance(anna)", 60), 0.55, 1e-9);
  // Within 0.6 m from x = 0.35 to 1.65 m, the ticks 7 to 33.
  EXPECT_NEAR(*Measure("final of intrusion_time(anna, 60 cm)", 60), 2.7, 1e-9);
  EXPECT_EQ(Measure("final of intrusions(anna, 60 cm)", 60), 1.0);
  EXPECT_EQ(Measure("max of people_near(anna, 60 cm)", 60), 1.0);
  EXPECT_EQ(Measure("final of people_near(anna, 60 cm)", 60), 0.0);
  EXPECT_EQ(Measure("final of sum r: intrusions(r, 10 m)", 60), 2.0);
}

TEST_F(MonitorTest, SignalsAreThoseOfTheWorld) {
  for (const char* const text : {"distance(anna, bob) >= 0.599 m and distance(anna, bob) <= 0.601 m",
                                 "distance(anna, wall) > 2.299 m",
                                 "distance(anna, dock) < 0.801 m and distance(bob, dock) > 1.799 m",
                                 "range(anna) < 2.501 m and range(anna) > 2.499 m",
                                 "eventually speed(anna) > 0.499 m/s",
                                 "always speed(bob) == 0",
                                 "always abs(heading(anna)) < 1 deg",
                                 "eventually event(stall_began, anna)",
                                 "always not event(stall_began, bob)",
                                 "finally count(event(stall_began)) == 1",
                                 "finally tick == 60",
                                 "finally abs(time - 6 s) < 1 ms",
                                 "within(yard) or true",
                                 "always all_alive",
                                 "always z(anna) == 0 m",
                                 "eventually (stalled(anna) and in(bob, yard))",
                                 "finally (count r: stalled(r)) == 1",
                                 "finally (max r: x(r)) > 2.29 m",
                                 "finally (mean r: x(r)) < 0.7 m",
                                 "finally distance(anna, wall) < 2 mm",
                                 "no_contact(59 cm)",
                                 "always exists r: at(r, dock, 3 m)",
                                 "eventually historically[0, 1 s] x(anna) > 1 m",
                                 "always (stalled(anna) -> once[0, 6 s] speed(anna) > 0.4 m/s)"}) {
    EXPECT_THAT(Run(text, 60), Satisfied()) << text;
  }
  Simulation simulation = Start();
  simulation.Step(30);
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(simulation.state_hash()));
  EXPECT_THAT(Run(std::string("state_hash(\"") + hash + "\")", 30), Satisfied());
  EXPECT_THAT(Run(std::string("state_hash(\"") + hash + "\")", 31), Violated());
}

TEST_F(MonitorTest, MetricsAreNumbersOfTheRun) {
  EXPECT_NEAR(Measure("time of first at(anna, dock, 22 cm)", 60).value(), 1.6, 1e-9);
  EXPECT_EQ(Measure("time of last at(r, dock, 22 cm)", 60), std::nullopt) << "bob never arrives";
  EXPECT_NEAR(Measure("time of last exists r: at(r, dock, 22 cm)", 60).value(), 1.6, 1e-9);
  EXPECT_NEAR(Measure("time of last x(r) + 2 * y(r) > -2 m", 60).value(), 0.0, 1e-9) << "both";
  EXPECT_EQ(Measure("time of first at(bob, dock)", 60), std::nullopt);
  EXPECT_NEAR(Measure("min of distance(a, b)", 20).value(), 0.6, 1e-9);
  EXPECT_NEAR(Measure("max of x(r)", 20).value(), 1.0, 1e-9);
  EXPECT_NEAR(Measure("mean of x(anna)", 20).value(), 0.5, 1e-9);
  EXPECT_NEAR(Measure("mean of x(r)", 20).value(), -0.25, 1e-9);
  EXPECT_NEAR(Measure("x(anna) - x(bob)", 20).value(), 2.0, 1e-9);
}

TEST_F(MonitorTest, ValuesThatAreNoNumbersAreLeftOutAndCounted) {
  Simulation simulation = Start();
  MetricMonitor least(Metric::Parse("min of x(anna) / speed(anna)", {simulation.world()}).value());
  MetricMonitor last(Metric::Parse("final of y(bob) / speed(bob)", {simulation.world()}).value());
  for (Tick i = 0; i <= 5; ++i) {
    if (i > 0) simulation.Step();
    ASSERT_TRUE(least.Push(simulation).ok());
    ASSERT_TRUE(last.Push(simulation).ok());
  }
  least.Finish();
  last.Finish();
  EXPECT_NEAR(least.value().value_or(-1.0), 0.1, 1e-9) << "at tick 1";
  EXPECT_EQ(least.undefined(), 1u);
  EXPECT_EQ(last.value(), std::nullopt) << "bob stands";
  EXPECT_EQ(last.undefined(), 6u);
}

TEST_F(MonitorTest, ABranchContinuesWithACopy) {
  Simulation simulation = Start();
  const ExpectationScope scope{simulation.world()};
  Monitor monitor(
      Expectation::Parse("always (stalled(anna) -> eventually[0, 5 ticks] not stalled(anna))", scope).value());
  for (int i = 0; i <= 30; ++i) {
    if (i > 0) simulation.Step();
    ASSERT_TRUE(monitor.Push(simulation).ok());
  }
  const Snapshot snapshot = simulation.Save().value();
  Monitor branch = monitor;
  for (int i = 0; i < 30; ++i) {
    simulation.Step();
    ASSERT_TRUE(monitor.Push(simulation).ok());
  }
  EXPECT_EQ(monitor.verdict(), Verdict::kFalse);
  ASSERT_TRUE(simulation.Restore(snapshot).ok());
  EXPECT_FALSE(monitor.Push(simulation).ok());                // the tick is not the next one
  ASSERT_TRUE(simulation.Drive(RobotId(0), Command{}).ok());  // in this branch anna stops
  for (int i = 0; i < 30; ++i) {
    simulation.Step();
    ASSERT_TRUE(branch.Push(simulation).ok());
  }
  EXPECT_EQ(branch.verdict(), Verdict::kUndecided);
  branch.Finish();
  EXPECT_EQ(branch.verdict(), Verdict::kTrue);
  EXPECT_FALSE(branch.Push(simulation).ok());
}

TEST_F(MonitorTest, TheStatesOfARunGiveTheBitsOfTheRun) {
  Simulation simulation = Start();
  const std::string text =
      "always (range(anna) + distance(anna, wall) > 1 m or eventually[0, 1 s] event(stall_began, anna) or "
      "stalled(anna))";
  Monitor live(Expectation::Parse(text, {simulation.world()}).value());
  std::vector<WorldState> states;
  std::vector<std::vector<Event>> events;
  for (int i = 0; i <= 60; ++i) {
    if (i > 0) simulation.Step();
    ASSERT_TRUE(live.Push(simulation).ok());
    states.push_back(simulation.state());
    events.push_back(simulation.events());
  }
  live.Finish();

  const Scene scene(world_.world());
  BodyIndex bodies(scene);
  Monitor replayed(live.expectation());
  for (std::size_t i = 0; i < states.size(); ++i) {
    bodies.Assign(states[i]);
    ASSERT_TRUE(replayed.Push(TickView{scene, bodies, states[i], events[i]}).ok());
  }
  replayed.Finish();
  EXPECT_EQ(replayed.robustness(), live.robustness());
  EXPECT_EQ(replayed.decided_at(), live.decided_at());
  EXPECT_EQ(replayed.cause(), live.cause());
  EXPECT_TRUE(
      std::equal(replayed.history().begin(), replayed.history().end(), live.history().begin(), live.history().end()));
}

TEST_F(MonitorTest, MatchersNameTheFormulaTheTickAndTheRobots) {
  const Monitor monitor = Run("no_contact(70 cm)", 5);
  EXPECT_THAT(monitor, Violated());
  EXPECT_THAT(monitor, Not(Satisfied()));
  EXPECT_THAT(Run("no_contact(50 cm)", 5), HasRobustness(Gt(0.05)));
  EXPECT_EQ(::testing::PrintToString(monitor),
            "\"forall a, b: always distance(a, b) > 70 cm\", which is false since tick 0, robustness -0.1, decided by "
            "tick 0 of anna and bob");
  Simulation simulation = Start();
  const Result<Monitor> wrong = Watch(simulation, 5, "always stalled(ana)");
  EXPECT_THAT(wrong, Not(Satisfied()));
  EXPECT_NE(::testing::PrintToString(wrong).find("did you mean 'anna'?, in: always stalled(ana)"), std::string::npos);
}

// The rows "| `FORMULA` | `SCENARIO` | VERDICT |" of docs/testing.md.
TEST(ExpectationExamplesTest, TheExamplesOfTheDocumentationHaveTheirVerdicts) {
  const char* const source = std::getenv("TROUPE_SOURCE_DIR");
  if (source == nullptr) GTEST_SKIP() << "TROUPE_SOURCE_DIR is not set";
  std::ifstream page(std::string(source) + "/docs/testing.md");
  std::map<std::string, std::vector<std::pair<std::string, std::string>>> examples;  // by scenario
  int count = 0;
  for (std::string line; std::getline(page, line);) {
    const std::size_t scenario = line.find("` | `");
    const std::size_t end = line.find(".json` | ");
    if (!line.starts_with("| `") || scenario == std::string::npos || end == std::string::npos) continue;
    const std::string name = line.substr(scenario + 5, end + 5 - scenario - 5);
    const std::string verdict = line.substr(end + 9, line.find(' ', end + 9) - end - 9);
    examples[name].emplace_back(line.substr(3, scenario - 3), verdict);
    ++count;
  }
  EXPECT_GE(count, 10);
  for (const auto& [name, formulas] : examples) {
    Result<Simulation> simulation = Simulation::Load(std::string(source) + "/worlds/scenarios/" + name);
    ASSERT_TRUE(simulation.ok()) << simulation.error().ToString();
    std::vector<std::string> texts;
    for (const auto& [text, verdict] : formulas) texts.push_back(text);
    const Result<std::vector<Monitor>> monitors = WatchAll(simulation.value(), 300, texts);
    ASSERT_TRUE(monitors.ok()) << monitors.error().ToString();
    for (std::size_t i = 0; i < formulas.size(); ++i) {
      EXPECT_EQ(NameOf(monitors.value()[i].verdict()), formulas[i].second)
          << ::testing::PrintToString(monitors.value()[i]);
    }
  }
}

}  // namespace
}  // namespace troupe
