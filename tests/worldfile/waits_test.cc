// What robots on lanes wait for, as states, signals and events have it.
#include <algorithm>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>

#include "common/signals/state_tables.h"
#include "common/signals/traffic_totals.h"
#include "tests/worldfile/on_lanes.h"
#include "tests/worldfile/scenario_run.h"

namespace troupe {
namespace {

// Two ways from a to b; the one through the middle is shorter.
constexpr const char* kTwoRoutes = R"(
name: two_ways
coordinate_system: cartesian_meters
levels:
  L1:
    elevation: 0
    vertices:
      - [0, 0, 0, a, {spawn_robot_name: [1, r1], spawn_robot_type: [1, TinyRobot]}]
      - [6, 0, 0, b]
      - [0, 3, 0, ""]
      - [6, 3, 0, ""]
    lanes:
      - [0, 1, {bidirectional: [4, true]}]
      - [0, 2, {bidirectional: [4, true]}]
      - [2, 3, {bidirectional: [4, true]}]
      - [3, 1, {bidirectional: [4, true]}]
)";

// The same without the other way.
constexpr const char* kOneWay = R"(
name: one_way
coordinate_system: cartesian_meters
levels:
  L1:
    elevation: 0
    vertices:
      - [0, 0, 0, a, {spawn_robot_name: [1, r1], spawn_robot_type: [1, TinyRobot]}]
      - [6, 0, 0, b]
    lanes:
      - [0, 1, {bidirectional: [4, true]}]
)";

// A door beside the start.
constexpr const char* kGatedLane = R"(
name: gate
coordinate_system: cartesian_meters
levels:
  L1:
    elevation: 0
    vertices:
      - [0, 0, 0, a, {spawn_robot_name: [1, r1], spawn_robot_type: [1, TinyRobot]}]
      - [5, 0, 0, b]
      - [0.55, -0.7, 0, ""]
      - [0.55, 0.7, 0, ""]
    lanes:
      - [0, 1, {bidirectional: [4, true]}]
    doors:
      - [2, 3, {name: [1, gate], type: [1, sliding], motion_axis: [1, start], motion_degrees: [3, 90],
                motion_direction: [2, 1], right_left_ratio: [3, 1], plugin: [1, normal]}]
)";

// With a box on the straight lane.
WorldDescription LoadWithBox(const test::TemporaryFolder& folder, const std::string& building, bool is_planned) {
  folder.Write("s.building.yaml", building);
  const std::string planned = is_planned ? R"("planned": true, )" : "";
  const std::string text = R"({"world": "s.building.yaml",
    "models": [{"name": "box", "model": "model", "pose": [3, 0, 0], "properties": {"size": [0.5, 0.5, 0.5]}}],
    "robots": [)" + OnLanes("r1", "{" + planned + R"("places": ["b", "a"]})") +
                           "]}";
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  return test::ValueOf(LoadWorld(folder.Write("s.json", text), overrides)).world;
}

std::string TextOfSignal(const ScenarioRun& run, const char* table, const char* signal, std::size_t row) {
  const Things things(run.scene().world());
  return StateTables()[KindOf(table)].Find(signal)->text({things, run.scene().world(), run.state()}, row);
}
double NumberOfSignal(const ScenarioRun& run, const char* table, const char* signal, std::size_t row) {
  const Things things(run.scene().world());
  return StateTables()[KindOf(table)].Find(signal)->number({things, run.scene().world(), run.state()}, row);
}

std::size_t CountEvents(const ScenarioRun& run, EventType type) {
  return static_cast<std::size_t>(
      std::count_if(run.events().begin(), run.events().end(), [&](const Event& event) { return event.type == type; }));
}

void RunUntilWait(ScenarioRun& run, int ticks) {
  while (ticks-- > 0 && run.state().waits.empty()) run.Run(1);
}

class WaitsAtABox : public testing::TestWithParam<bool> {};

TEST_P(WaitsAtABox, HaveTheBoxAndTheirTime) {
  test::TemporaryFolder folder;
  ScenarioRun run(LoadWithBox(folder, kOneWay, GetParam()));
  RunUntilWait(run, 200);
  ASSERT_EQ(run.state().waits.size(), 1u);
  EXPECT_EQ(TextOfSignal(run, "robots", "blocked_by", 0), "box");
  EXPECT_EQ(NumberOfSignal(run, "robots", "wait_time", 0), 0.0);
  run.Run(20);
  EXPECT_EQ(TextOfSignal(run, "robots", "blocked_by", 0), "box");
  EXPECT_NEAR(NumberOfSignal(run, "robots", "wait_time", 0), 2.0, 1e-9);
  EXPECT_EQ(NumberOfSignal(run, "lanes", "waiting_robots", 0), 1.0);
  EXPECT_NEAR(NumberOfSignal(run, "lanes", "longest_wait", 0), 2.0, 1e-9);
  EXPECT_EQ(CountEvents(run, EventType::kWaitBegan), 0u) << "only a long wait is told";
}

INSTANTIATE_TEST_SUITE_P(PlannedOrNot, WaitsAtABox, testing::Bool());

TEST(PlannedWaits, ALaneThatABoxClosesIsToldOnceAndTheRobotGoesRound) {
  test::TemporaryFolder folder;
  ScenarioRun run(LoadWithBox(folder, kTwoRoutes, true));
  run.Run(600);
  ASSERT_EQ(CountEvents(run, EventType::kReplanned), 1u);
  const auto replanned = std::find_if(run.events().begin(), run.events().end(),
                                      [](const Event& event) { return event.type == EventType::kReplanned; });
  EXPECT_EQ(replanned->robot, run.Find("r1"));
  ASSERT_TRUE(replanned->other);
  EXPECT_EQ(run.scene().world().model(*replanned->other).name, "box");
  EXPECT_NE(replanned->detail.find("lane 0: a - b is closed for"), std::string::npos) << replanned->detail;
  EXPECT_GT(run.state().traffic_robots[0].arrivals, 0u) << "it has gone round";
}

TEST(PlannedWaits, ARobotWithoutAWayIsToldAndTheLogIsNotFlooded) {
  test::TemporaryFolder folder;
  ScenarioRun run(LoadWithBox(folder, kOneWay, true));
  bool waits_for_lane = false;
  for (int i = 0; i < 3000; ++i) {
    run.Run(1);
    waits_for_lane = waits_for_lane || TextOfSignal(run, "robots", "blocked_by", 0) == "0: a - b";
  }
  EXPECT_TRUE(waits_for_lane) << "a closed lane is named";
  const auto no_way = std::find_if(run.events().begin(), run.events().end(),
                                   [](const Event& event) { return event.type == EventType::kNoWay; });
  ASSERT_NE(no_way, run.events().end());
  EXPECT_EQ(no_way->detail, "b; lane 0: a - b is closed");
  const auto of_traffic = std::count_if(run.events().begin(), run.events().end(),
                                        [](const Event& event) { return IsOfTraffic(event.type); });
  EXPECT_LE(of_traffic, 3000 / 100 + 10) << "one for each wait of 10 s at most, and one for each closure";
}

TEST(Waits, ForADoorThatOpensHaveIt) {
  test::TemporaryFolder folder;
  for (
      const std::string& robot :
      {OnLanes("r1", R"({"places": ["b"]})"), OnLanes("r1", R"({"places": ["b"], "planned": true})"),
       std::string(
           R"({"name": "r1", "controller": {"name": "go_to", "parameters": {"waypoints": [[5, 0]], "plan": true}}})")}) {
    WorldDescription world = LoadOnLanes(folder, kGatedLane, robot);
    world.doors[0].opening = 0.0;  // it opens for no robot by itself
    world.doors[0].detection_radius = 0.0;
    ScenarioRun run(std::move(world));
    for (int i = 0; i < 50 && TextOfSignal(run, "robots", "blocked_by", 0) != "gate"; ++i) run.Run(1);
    EXPECT_EQ(TextOfSignal(run, "robots", "blocked_by", 0), "gate") << robot;
    EXPECT_EQ(NumberOfSignal(run, "doors", "waiting_robots", 0), 1.0);
    run.Run(100);
    EXPECT_EQ(NumberOfSignal(run, "doors", "waiting_robots", 0), 0.0) << "it is open";
    EXPECT_TRUE(run.state().waits.empty());
  }
}

// Of robots that find their own ways: the lift of a house, and each other.
TEST(Waits, ForALiftAreCountedAtIt) {
  const char* const source = std::getenv("TROUPE_SOURCE_DIR");
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  const std::string file = std::string(source == nullptr ? "." : source) + "/worlds/sites/guesthouse_lanes.json";
  ScenarioRun run(test::ValueOf(LoadWorld(file, overrides)).world);
  std::set<std::string> blockers;
  double at_lifts = 0.0;
  TrafficTotals totals;
  for (int i = 0; i < 1500; ++i) {
    run.Run(1);
    totals.Add(run.scene().world(), run.state());
    for (const RobotWait& wait : run.state().waits) {
      blockers.insert(TextOfSignal(run, "robots", "blocked_by", wait.robot.index()));
    }
    for (std::size_t lift = 0; lift < run.state().lifts.size(); ++lift) {
      at_lifts += NumberOfSignal(run, "lifts", "waiting_robots", lift);
    }
  }
  EXPECT_TRUE(blockers.contains("guest_lift"));
  EXPECT_TRUE(blockers.contains("tiny_1"));
  EXPECT_GT(at_lifts, 0.0);
  double seconds = 0.0;
  for (const PlaceWaits& place : totals.FindWaits(run.scene().world(), 10)) {
    if (place.kind == "lift") seconds += place.seconds;
  }
  EXPECT_NEAR(seconds, 0.1 * at_lifts, 0.2) << "robot-seconds, but for the first tick";
}

// A room of 1 m by 8 m, in which nothing can be passed. `more`: models; `things`: keys of the scenario.
WorldDescription LoadCorridor(const test::TemporaryFolder& folder, const std::string& controller,
                              const std::string& more, const std::string& things) {
  folder.Write("s.building.yaml", kOneWay);
  const auto wall = [](const std::string& name, const std::string& pose, const std::string& size) {
    return R"({"name": ")" + name + R"(", "model": "model", "pose": )" + pose + R"(, "properties": {"size": )" + size +
           "}}";
  };
  const std::string walls =
      wall("north", "[3, 0.6, 0]", "[8.4, 0.2, 1]") + ", " + wall("south", "[3, -0.6, 0]", "[8.4, 0.2, 1]") + ", " +
      wall("west", "[-1.1, 0, 0]", "[0.2, 1, 1]") + ", " + wall("east", "[7.1, 0, 0]", "[0.2, 1, 1]") + more;
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  return test::ValueOf(
             LoadWorld(folder.Write("s.json", R"({"world": "s.building.yaml", "models": [)" + walls + "]" + things +
                                                  R"(, "robots": [{"name": "r1", "controller": )" + controller + "}]}"),
                       overrides))
      .world;
}

constexpr const char* kGoTo = R"({"name": "go_to", "parameters": {"waypoints": [[6, 0]], "plan": true}})";
constexpr const char* kPatrol = R"({"name": "patrol", "parameters": {"waypoints": [[6, 0], [0, 0]], "plan": true}})";

TEST(WaitsOfGoTo, NameTheRobotPersonOrObjectInTheWay) {
  test::TemporaryFolder folder;
  struct Thing {
    std::string name;
    const char* models;
    const char* keys;
  };
  const Thing things[] = {
      {"bela0", "",
       R"(, "spawn": [{"model": "TinyRobot", "count": 1, "region": [2.9, -0.1, 3.1, 0.1], "name_prefix": "bela"}])"},
      {"box",
       R"(, {"name": "box", "model": "model", "pose": [3, 0, 0], "properties": {"size": [0.5, 0.5, 0.5], "gripper_return": 1}})",
       ""},
      {"carl1", "", R"(, "people": [{"count": 1, "region": [2.9, -0.05, 3.1, 0.05], "name_prefix": "carl"}])"}};
  for (const char* const controller : {kGoTo, kPatrol}) {
    for (const Thing& thing : things) {
      SCOPED_TRACE(thing.name + " " + controller);
      ScenarioRun run(LoadCorridor(folder, controller, thing.models, thing.keys));
      RunUntilWait(run, 200);
      ASSERT_FALSE(run.state().waits.empty());
      run.Run(20);
      EXPECT_EQ(TextOfSignal(run, "robots", "blocked_by", 0), thing.name);
      EXPECT_NEAR(NumberOfSignal(run, "robots", "wait_time", 0), 2.0, 1e-9);
      run.Run(400);
      EXPECT_GE(CountEvents(run, EventType::kWaitBegan), 1u);
    }
  }
}

}  // namespace
}  // namespace troupe
