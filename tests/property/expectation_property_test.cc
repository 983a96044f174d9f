// Random formulas over random runs: monitors against an evaluator that follows the definitions word by word. And over
// one run: the live one, its recording and branches of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/model/states.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "recording/recording.h"
#include "testing/expectations/rewrite.h"
#include "testing/expectations/signals.h"
#include "testing/expectations/syntax.h"
#include "testing/expectations/tick_view.h"
#include "tests/property/naive_evaluator.h"
#include "tests/property/random_formula.h"
#include "tests/support/controlled_run.h"
#include "tests/support/small_world.h"
#include "troupe/expectation.h"
#include "troupe/simulation.h"
#include "world-service/replay/replayed_world.h"

namespace troupe::test {
namespace {

// Any rows: not those of a possible run.
WorldState RandomState(const Scene& scene, Tick tick, RandomFormula& random) {
  const WorldDescription& world = scene.world();
  WorldState state = PlacedState(world);
  state.tick = tick;
  const auto place = [&](Pose& pose) {
    pose.x = random.Below(7) - 3;  // whole numbers: equal ones are frequent
    pose.y = random.Below(7) - 3;
    pose.z = random.Below(4) == 0 ? 1.0 : 0.0;
    pose.heading = random.Below(4) - 1;
  };
  for (std::size_t i = 0; i < state.robots.size(); ++i) {
    RobotState& robot = state.robots[i];
    place(robot.X_WR);
    robot.twist = {1.0 * random.Below(3), 0.0, 1.0 * random.Below(3) - 1.0};
    robot.stalled = random.Below(2) == 0;
    if (random.Below(3) > 0) continue;
    for (std::size_t radio = 0; radio < world.robots[i].sensors.size(); ++radio) {
      if (TypeOf(world.robots[i].sensors[radio].parameters) != "radio") continue;
      state.transmissions.push_back({RobotId(i), tick, tick, 0, {radio, {}, {1, 2, 3}}});
    }
  }
  for (PersonState& person : state.people) place(person.X_WP);
  for (JointState& joint : state.joints) joint = {0.1 * random.Below(3), 1.0 * random.Below(2), random.Below(2) == 0};
  for (StoreState& store : state.stores) store = {1.0 * random.Below(4), 1.0 * random.Below(3)};
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    ObjectState& object = state.objects[i];
    place(object.X_WO);
    object.mode = static_cast<ObjectMode>(random.Below(3));
    if (random.Below(2) == 0) continue;
    const GripperId gripper(static_cast<std::size_t>(random.Below(static_cast<int>(state.grippers.size()))));
    state.grippers[gripper.index()].clamped = ObjectId(i);
    if (random.Below(3) == 0) continue;  // another one holds it, or none
    object.mode = ObjectMode::kHeld;
    object.holder = gripper;
  }
  return state;
}

std::vector<Event> RandomEvents(const WorldDescription& world, Tick tick, RandomFormula& random) {
  std::vector<Event> events;
  while (tick > 0 && random.Below(3) > 0) {
    Event event{.tick = tick, .type = static_cast<EventType>(random.Below(static_cast<int>(LastOf(EventType{})) + 1))};
    event.robot = RobotId(static_cast<std::size_t>(random.Below(static_cast<int>(world.robots.size()))));
    if (random.Below(2) == 0) {
      event.object = world.objects[static_cast<std::size_t>(random.Below(static_cast<int>(world.objects.size())))];
    }
    event.detail = random.Below(2) == 0 ? "done it" : "it is done";
    events.push_back(event);
  }
  return events;
}

std::vector<RunTick> RandomRun(const Scene& scene, RandomFormula& random) {
  std::vector<RunTick> run;
  const int ticks = 1 + random.Below(14);
  for (int t = 0; t < ticks; ++t) {
    const auto tick = static_cast<Tick>(t);
    run.push_back({RandomState(scene, tick, random), RandomEvents(scene.world(), tick, random), BodyIndex(scene)});
    run.back().bodies.Assign(run.back().state);
  }
  return run;
}

std::string HashOf(const WorldState& state) {
  char digits[17];
  std::snprintf(digits, sizeof(digits), "%016llx", static_cast<unsigned long long>(StateHash(state)));
  return digits;
}

void ExpectSame(double found, double expected) {
  EXPECT_EQ(found, expected);
  EXPECT_EQ(std::signbit(found), std::signbit(expected));
}

void ExpectSame(const Monitor& found, const Monitor& expected) {
  ExpectSame(found.robustness(), expected.robustness());
  EXPECT_EQ(found.verdict(), expected.verdict());
  EXPECT_EQ(found.decided_at(), expected.decided_at());
  EXPECT_EQ(found.cause(), expected.cause());
  EXPECT_TRUE(
      std::equal(found.history().begin(), found.history().end(), expected.history().begin(), expected.history().end()));
}

// The signals that a formula reads.
void FindSignals(const Syntax& formula, std::set<std::string>& names) {
  if (formula.kind == SyntaxKind::kCall || formula.kind == SyntaxKind::kName) names.insert(formula.name);
  for (const Syntax& child : formula.children) FindSignals(child, names);
}

void ExpectAllSignals(const std::set<std::string>& names) {
  for (const SignalInfo& signal : RunSignals()) EXPECT_TRUE(names.contains(signal.name)) << signal.name;
}

TEST(ExpectationPropertyTest, RobustnessHasTheValueAndSignOfTheDefinitions) {
  const WorldDescription world = ExpectationWorld();
  const Scene scene(world);
  const ExpectationScope scope{world, std::span(&kYard, 1)};
  int decided_early = 0;
  std::set<std::string> signals;
  for (std::uint32_t seed = 0; seed < 4000 && !HasFailure(); ++seed) {
    RandomFormula random(seed);
    const std::vector<RunTick> run = RandomRun(scene, random);
    const std::string text = random.Formula(1 + random.Below(4), HashOf(run.back().state));
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + text);
    const Result<Expectation> expectation = Expectation::Parse(text, scope);
    ASSERT_TRUE(expectation.ok()) << expectation.error().ToString();
    const Result<Syntax> syntax = ParseFormula(text);
    ASSERT_TRUE(syntax.ok());
    FindSignals(syntax.value(), signals);
    // What is printed is the same formula.
    ASSERT_EQ(ToString(ParseFormula(expectation.value().formula()).value()), expectation.value().formula());

    Monitor monitor(expectation.value());
    std::optional<Monitor> branch;  // a copy from any tick continues like the first one
    Interval bounds{-kNothing, kNothing};
    for (const RunTick& tick : run) {
      const TickView view{scene, tick.bodies, tick.state, tick.events};
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
    NaiveEvaluator naive(scene, kYard, run);
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
      ExpectSame(*branch, monitor);
    }
    ASSERT_FALSE(monitor.history().empty());
  }
  EXPECT_GT(decided_early, 500);  // verdicts do not wait for the end of the run
  ExpectAllSignals(signals);
}

// Pushes the states of a recording, which have these hashes, into the monitors.
void PushRecording(const std::string& path, const std::vector<std::uint64_t>& hashes, std::vector<Monitor>& monitors) {
  const Recording recording = Recording::Open(path).value();
  ReplayCursor cursor = ReplayCursor::At(recording).value();
  const ReplayedWorld& replay = cursor.world();
  std::size_t states = 0;
  for (; cursor.Next().value() != nullptr; ++states) {
    ASSERT_TRUE(cursor.Advance().ok());
    ASSERT_EQ(replay.state_hash(), hashes.at(states));
    const std::span<const Event> of_step = states == 0 ? std::span<const Event>() : cursor.tick().events;
    const TickView view{*replay.scene(), replay.bodies(), replay.state(), of_step};
    for (Monitor& monitor : monitors) ASSERT_TRUE(monitor.Push(view).ok());
  }
  EXPECT_EQ(states, hashes.size());
}

TEST(ExpectationPropertyTest, LiveReplayedAndBranchedRunsHaveTheSameResults) {
  constexpr Tick kTicks = 60;
  const TemporaryFolder folder;
  const WorldDescription world = ExpectationWorld();
  {
    ControlledRun run(world, {.outputs = {.record = folder.Path("run.mcap"), .keyframe_interval = 20}});
    run.Step(kTicks);
    ASSERT_TRUE(run.Finish().ok());
  }
  Simulation simulation = Simulation::Create(world).value();
  simulation.Step(kTicks);
  const std::string last_hash = HashOf(simulation.state());

  std::vector<Monitor> live;
  std::vector<Tick> branch_at;  // of each monitor
  std::set<std::string> signals;
  for (std::uint32_t seed = 0; seed < 1000; ++seed) {
    RandomFormula random(seed);
    const std::string text = random.Formula(1 + random.Below(4), last_hash);
    live.emplace_back(Expectation::Parse(text, {simulation.world(), std::span(&kYard, 1)}).value());
    branch_at.push_back(static_cast<Tick>(1 + random.Below(6)) * 9);
    FindSignals(ParseFormula(text).value(), signals);
  }
  ExpectAllSignals(signals);
  std::vector<Monitor> replayed = live;
  std::vector<std::optional<Monitor>> branched(live.size());

  std::vector<Snapshot> snapshots;
  std::vector<std::uint64_t> hashes;
  std::set<EventType> events;
  simulation = Simulation::Create(world).value();
  for (Tick tick = 0; tick <= kTicks; ++tick) {
    if (tick > 0) simulation.Step();
    snapshots.push_back(simulation.Save().value());
    hashes.push_back(simulation.state_hash());
    for (const Event& event : simulation.events()) events.insert(event.type);
    for (std::size_t i = 0; i < live.size(); ++i) {
      ASSERT_TRUE(live[i].Push(simulation).ok());
      if (tick == branch_at[i]) branched[i] = live[i];
    }
  }
  ASSERT_TRUE(simulation.failures().empty());
  for (const EventType type : {EventType::kStallBegan, EventType::kGripped, EventType::kReleased, EventType::kLanded,
                               EventType::kOutOfEnergy, EventType::kSaid}) {
    EXPECT_TRUE(events.contains(type)) << NameOf(type);
  }

  for (Tick from = 9; from < kTicks; from += 9) {
    Simulation branch = Simulation::Continue(snapshots[from]).value();
    while (branch.tick() < kTicks) {
      branch.Step();
      for (std::size_t i = 0; i < live.size(); ++i) {
        if (branch_at[i] != from) continue;
        ASSERT_TRUE(branched[i]->Push(branch).ok());
      }
    }
    EXPECT_EQ(branch.state_hash(), hashes.back());
  }

  PushRecording(folder.Path("run.mcap"), hashes, replayed);

  int holding = 0;
  std::set<double> robustness;
  for (std::size_t i = 0; i < live.size() && !HasFailure(); ++i) {
    SCOPED_TRACE("seed " + std::to_string(i) + ": " + live[i].expectation().text());
    for (Monitor* const monitor : {&live[i], &replayed[i], &*branched[i]}) monitor->Finish();
    ExpectSame(replayed[i], live[i]);
    ExpectSame(*branched[i], live[i]);
    holding += live[i].verdict() == Verdict::kTrue ? 1 : 0;
    robustness.insert(live[i].robustness());
  }
  EXPECT_GT(holding, 125);
  EXPECT_LT(holding, 875);
  EXPECT_GT(robustness.size(), 60u);  // the run decides them, not their form
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
}  // namespace troupe::test
