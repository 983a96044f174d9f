// What an operator of a site has: automatic doors, lifts with limits, chargers that several robots want, closed lanes
// and zones, goods, and cleaning.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "common/model/lane_rules.h"
#include "common/model/states.h"
#include "common/model/zones.h"
#include "tests/support/values.h"
#include "tests/worldfile/on_lanes.h"
#include "tests/worldfile/scenario_run.h"
#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

using test::ValueOf;
using testing::HasSubstr;

// A cart that reaches any speed at once.
const std::string kCart = R"(
  define cart position (
    size [0.4 0.4 0.5] drive "omni" velocity_bounds [-2 2 -2 2 0 0 -90 90]
    acceleration_bounds [-100 100 -100 100 0 0 -1000 1000]
  )
)";

Simulation SimulateSite(const std::string& world, const std::string& people = "") {
  test::TemporaryFolder folder;
  folder.Write("w.world", kCart + world);
  return ValueOf(Simulation::Load(folder.Write(
      "s.json", R"({"world": "w.world")" + (people.empty() ? "" : R"(, "people": [)" + people + "]") + "}")));
}

// People that stand in a small region.
std::string Standing(int count, double x, double y, double side, const std::string& z = "0") {
  const auto number = [](double value) { return std::to_string(value); };
  return R"({"count": )" + std::to_string(count) + R"(, "z": )" + z + R"(, "region": [)" + number(x) + ", " +
         number(y) + ", " + number(x + side) + ", " + number(y + side) + "]}";
}

void DriveFor(Simulation& run, double vx, int ticks) {
  ASSERT_TRUE(run.Drive(*run.FindRobot("r"), {.twist = {vx, 0.0, 0.0}}).ok());
  for (int i = 0; i < ticks; ++i) run.Step();
}

// Doors.

TEST(AutomaticDoors, OpenForTheRegionOfTheirSensorAndHold) {
  Simulation run = SimulateSite(
      "door ( name \"d\" pose [0 0 0 90] kind \"sliding\" seconds 1 sensor_depth 1.2 sensor_width 1 hold 1 )"
      "cart ( name \"r\" pose [-4 0 0 0] )");
  DriveFor(run, 0.5, 55);  // at -1.25
  EXPECT_EQ(run.state().doors[0].opening, 0.0);
  DriveFor(run, 0.5, 13);
  EXPECT_EQ(run.state().doors[0].opening, 1.0);
  while (run.state().robots[0].X_WR.x <= 1.2) DriveFor(run, 0.5, 1);
  for (int i = 0; i < 9; ++i) {
    DriveFor(run, 0.5, 1);
    EXPECT_EQ(run.state().doors[0].opening, 1.0) << i;
  }
  DriveFor(run, 0.5, 13);
  EXPECT_EQ(run.state().doors[0].opening, 0.0);
  // Beside the region, on the same height.
  Simulation beside = SimulateSite(
      "door ( name \"d\" pose [0 0 0 90] kind \"sliding\" seconds 1 sensor_depth 1.2 sensor_width 1 )"
      "cart ( name \"r\" pose [-1 0.6 0 0] )");
  beside.Step(20);
  EXPECT_EQ(beside.state().doors[0].opening, 0.0);
}

TEST(AutomaticDoors, OpenForPeopleAtTheSensor) {
  const std::string door =
      "door ( name \"d\" pose [0 0 0 90] size [1.6 0.04 2] kind \"double_sliding\" seconds 1 sensor_depth 1 )";
  Simulation near = SimulateSite(door, Standing(1, -0.8, 0.0, 0.05));
  near.Step(15);
  EXPECT_EQ(near.state().doors[0].opening, 1.0);
  EXPECT_TRUE(near.state().doors[0].held);
  Simulation far = SimulateSite(door, Standing(1, -1.5, 0.0, 0.05));
  far.Step(15);
  EXPECT_EQ(far.state().doors[0].opening, 0.0);
}

TEST(AutomaticDoors, ReopenAtABody) {
  Simulation run = SimulateSite(
      "door ( name \"d\" pose [0 0 0 90] kind \"sliding\" seconds 1 opening 1 reopens 1 hold 0.5 )"
      "cart ( name \"r\" pose [0 0 0 0] )");
  ASSERT_TRUE(run.AddInput({{}, DoorOrder{0, 0.0}}).ok());
  int reopened = 0;
  bool was_open = true;
  for (int i = 0; i < 100; ++i) {
    run.Step();
    const bool is_open = run.state().doors[0].opening == 1.0;
    reopened += is_open && !was_open ? 1 : 0;
    was_open = is_open;
    EXPECT_GT(run.state().doors[0].opening, 0.0);
  }
  EXPECT_GE(reopened, 3);
  DriveFor(run, 1.0, 30);
  EXPECT_EQ(run.state().doors[0].opening, 0.0) << "its target is still to be closed";
}

TEST(AutomaticDoors, FaultsAreNamed) {
  test::TemporaryFolder folder;
  const Result<LoadedWorld> loaded =
      LoadWorld(folder.Write("w.world", "door ( name \"d\" kind \"sliding\" sensor_width 2 )"));
  ASSERT_FALSE(loaded.ok());
  EXPECT_THAT(loaded.error().ToString(), HasSubstr("w.world:1:"));
  EXPECT_THAT(loaded.error().ToString(), HasSubstr("expected a 'sensor_depth' above 0"));
}

// Lifts.

std::string LimitedLift(const std::string& limits) {
  return R"(
  define leaf door ( size [1.2 0.04 2] kind "double_sliding" seconds 1 )
  leaf ( name "cabin_door" pose [-0.95 0 0 90] opening 1 )
  leaf ( name "lower" pose [-1.1 0 0 90] opening 1 )
  leaf ( name "upper" pose [-1.1 0 3 90] )
  lift (
    name "up" size [2 2 2.1] pose [0 0 0 0] floors ["ground" "first"] heights [0 3] speed 1 )" +
         limits + R"(
    cabin_doors ["cabin_door"]
    floor_doors ["ground" "cabin_door" "ground" "lower" "first" "cabin_door" "first" "upper"]
    block ( points 4 point[0] [0 0] point[1] [2 0] point[2] [2 2] point[3] [0 2] z [0 0.05] )
    block ( points 4 point[0] [1.95 0] point[1] [2 0] point[2] [2 2] point[3] [1.95 2] z [0.05 2.15] )
    block ( points 4 point[0] [0 0] point[1] [1.9 0] point[2] [1.9 0.05] point[3] [0 0.05] z [0.05 2.15] )
    block ( points 4 point[0] [0 1.95] point[1] [1.9 1.95] point[2] [1.9 2] point[3] [0 2] z [0.05 2.15] )
  )
)";
}

TEST(LimitedLifts, StayWithOpenDoorsUntilTheyCarryAll) {
  for (const char* const limits : {"capacity 1", "max_load 120"}) {
    Simulation run = SimulateSite(LimitedLift(limits) + R"(
      cart ( name "r" pose [-0.3 0 0.06 0] mass 60 )
      cart ( name "other" pose [0.4 0 0.06 0] mass 61 ))");
    ASSERT_TRUE(run.AddInput({{}, LiftOrder{.lift = 0, .floor = 1}}).ok());
    int told = 0;
    for (int i = 0; i < 60; ++i) {
      run.Step();
      told += std::count_if(run.events().begin(), run.events().end(), [](const Event& event) {
        return event.type == EventType::kLiftOverloaded && event.detail == "ground";
      });
      EXPECT_EQ(run.state().lifts[0].z, 0.0);
      EXPECT_EQ(run.state().doors[0].opening, 1.0);
    }
    EXPECT_EQ(told, 1) << limits;
    EXPECT_TRUE(run.state().lifts[0].overloaded);
    DriveFor(run, -1.0, 15);
    DriveFor(run, 0.0, 60);
    EXPECT_FALSE(run.state().lifts[0].overloaded);
    EXPECT_EQ(run.state().lifts[0].z, 3.0) << limits;
  }
}

// Buildings.

TEST(SiteSpeeds, AreThoseOfOpenRmfUnlessTheFileSaysOtherwise) {
  const std::string site = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites/guesthouse.building.yaml";
  const WorldDescription world = ValueOf(LoadWorld(site)).world;
  ASSERT_FALSE(world.lifts.empty());
  for (const LiftDescription& lift : world.lifts) EXPECT_EQ(lift.speed, 2.0);
  ASSERT_FALSE(world.doors.empty());
  for (const DoorDescription& door : world.doors) {
    double fastest = 0.0;
    for (const DoorLeaf& leaf : door.leaves) {
      const double way = leaf.turn != 0.0 ? std::fabs(leaf.turn) / 0.5 : std::fabs(leaf.shift) / 0.2;
      fastest = std::max(fastest, way / door.seconds);
    }
    EXPECT_NEAR(fastest, 1.0, 1e-9) << world.model(door.model).name;
  }
  test::TemporaryFolder folder;
  const std::string lift = world.model(world.lifts[0].model).name;
  const std::string changed = folder.Write("s.json", R"({"world": ")" + site + R"(", "override": [
    {"match": {"type": "door"}, "properties": {"seconds": 4}},
    {"match": {"name": ")" + lift + R"("}, "properties": {"speed": 0.5}}]})");
  const WorldDescription slow = ValueOf(LoadWorld(changed)).world;
  EXPECT_EQ(slow.lifts[0].speed, 0.5);
  for (const DoorDescription& door : slow.doors) EXPECT_EQ(door.seconds, 4.0);
}

// Lanes and zones. Two ways from a to b: straight, and through c, which is longer.
constexpr const char* kTwoWays = R"(
name: two_ways
coordinate_system: cartesian_meters
levels:
  G:
    elevation: 0
    vertices:
      - [0, 0, 0, a, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, r]}]
      - [8, 0, 0, b]
      - [4, 4, 0, c]
    lanes:
      - [0, 1, {bidirectional: [4, true]}]
      - [0, 2, {bidirectional: [4, true]}]
      - [2, 1, {bidirectional: [4, true]}]
)";

// Its scenario, with further keys.
Simulation TwoWays(const std::string& keys, const std::string& parameters = R"({"places": ["b"], "repeat": false})") {
  test::TemporaryFolder folder;
  folder.Write("s.building.yaml", kTwoWays);
  return ValueOf(Simulation::Load(folder.Write(
      "s.json", R"({"world": "s.building.yaml", "robots": [)" + OnLanes("r", parameters) + "]" + keys + "}")));
}

struct Journey {
  double highest = 0.0;  // m, y
  double fastest = 0.0;  // m/s
  bool has_arrived = false;
  Tick ticks = 0;
};
Journey Travel(Simulation& run, int ticks) {
  Journey journey;
  for (int i = 0; i < ticks && !journey.has_arrived; ++i) {
    run.Step();
    const RobotState& robot = run.state().robots[0];
    journey.highest = std::max(journey.highest, robot.X_WR.y);
    journey.fastest = std::max(journey.fastest, std::hypot(robot.twist.vx, robot.twist.vy));
    journey.has_arrived = std::hypot(robot.X_WR.x - 8.0, robot.X_WR.y) < 0.15;
  }
  journey.ticks = run.tick();
  return journey;
}

std::string InPlan(bool planned) {
  return std::string(R"({"places": ["b"], "repeat": false)") + (planned ? "}" : R"(, "planned": false})");
}

TEST(SiteRules, AClosedLaneIsGoneRoundAndAnOpenOneUsedAgain) {
  for (const bool planned : {false, true}) {
    Simulation run = TwoWays("", InPlan(planned));
    ASSERT_TRUE(run.AddInput({{}, LaneOrder{*FindLane(run.world(), "b", "a"), 0.0}}).ok());
    const Journey round = Travel(run, 600);
    EXPECT_TRUE(round.has_arrived) << planned;
    EXPECT_GT(round.highest, 3.5) << planned;
    // Of each part of the lane.
    EXPECT_EQ(run.state().lane_rules.size(), LanesOnLine(run.world(), *FindLane(run.world(), "a", "b")).size());
  }
}

TEST(SiteRules, WithoutAnotherWayRobotsWait) {
  for (const bool planned : {false, true}) {
    Simulation run = TwoWays(R"(, "events": [
      {"at": 0, "lane": ["a", "b"], "closed": true}, {"at": 0, "lane": ["c", "b"], "closed": true},
      {"at": 40, "lane": ["b", "c"], "closed": false}])",
                             InPlan(planned));
    const Journey before = Travel(run, 395);
    EXPECT_FALSE(before.has_arrived) << planned;
    const Journey after = Travel(run, 600);
    EXPECT_TRUE(after.has_arrived) << planned;
    EXPECT_GT(after.highest, 3.5);
  }
}

TEST(SiteRules, KeepoutZonesAreHeededWhileTheyAreOn) {
  const std::string zone = R"(, "zones": [{"name": "wet", "kind": "keepout", "region": [3, -1, 5, 1], "on": )";
  for (const bool planned : {false, true}) {
    Simulation on = TwoWays(zone + "true}]", InPlan(planned));
    const Journey round = Travel(on, 600);
    EXPECT_TRUE(round.has_arrived) << planned;
    EXPECT_GT(round.highest, 3.5) << planned;
    Simulation off = TwoWays(zone + "false}]", InPlan(planned));
    EXPECT_LT(Travel(off, 600).highest, 0.2) << planned;
    Simulation switched =
        TwoWays(zone + R"(true}], "events": [{"at": 0, "zone": "wet", "on": false}])", InPlan(planned));
    EXPECT_LT(Travel(switched, 600).highest, 0.2) << planned;
  }
}

TEST(SiteRules, ARobotInAZoneLeavesIt) {
  Simulation run = TwoWays(R"(, "zones": [{"name": "wet", "kind": "keepout", "region": [-1, -1, 1, 1]}])");
  EXPECT_TRUE(Travel(run, 600).has_arrived);
}

TEST(SiteRules, SpeedsAreLimitedOnLanesAndInZones) {
  Simulation zone =
      TwoWays(R"(, "zones": [{"name": "slow", "kind": "speed", "speed_limit": 0.2, "region": [2, -1, 6, 1]}])");
  for (int i = 0; i < 400; ++i) {
    zone.Step();
    const RobotState& robot = zone.state().robots[0];
    if (robot.X_WR.x > 2.0 && robot.X_WR.x < 6.0) {
      EXPECT_LE(robot.twist.vx, 0.2 + 1e-9);
    }
  }
  EXPECT_GT(zone.state().robots[0].X_WR.x, 6.0);
  Simulation lane = TwoWays(R"(, "events": [{"at": 0, "lane": ["a", "b"], "speed_limit": 0.3}])");
  const Journey slow = Travel(lane, 600);
  EXPECT_TRUE(slow.has_arrived);
  EXPECT_LE(slow.fastest, 0.3 + 1e-9);
}

TEST(SiteRules, AreToldAsEvents) {
  Simulation run = TwoWays(R"(, "zones": [{"name": "wet", "kind": "keepout", "region": [3, -1, 5, 1]}], "events": [
      {"at": 1, "lane": ["a", "b"], "closed": true}, {"at": 2, "zone": "wet", "on": false},
      {"at": 3, "lane": ["a", "b"], "speed_limit": 0.5}, {"at": 4, "lane": ["a", "b"], "closed": false}])");
  std::vector<std::string> told;
  for (int i = 0; i < 50; ++i) {
    run.Step();
    for (const Event& event : run.events()) {
      if (event.type == EventType::kLaneSwitched || event.type == EventType::kZoneSwitched)
        told.push_back(event.detail);
    }
  }
  EXPECT_THAT(told, testing::ElementsAre("a - b: closed", "wet off", "a - b: 0.5 m/s", "a - b: open"));
}

TEST(SiteRules, FaultsOfScenariosAreNamed) {
  const auto error_of = [](const std::string& keys) {
    test::TemporaryFolder folder;
    folder.Write("s.building.yaml", kTwoWays);
    const Result<LoadedWorld> loaded =
        LoadWorld(folder.Write("s.json", "{\"world\": \"s.building.yaml\",\n" + keys + "}"));
    return loaded.ok() ? "" : loaded.error().ToString();
  };
  const struct {
    const char* keys;
    const char* text;
  } cases[] = {
      {R"("zones": [{"name": "z", "kind": "wet", "region": [0, 0, 1, 1]}])",
       "s.json:2:33: error: found the string 'wet'"},
      {R"("zones": [{"name": "z", "kind": "speed", "region": [0, 0, 1, 1]}])", "without 'speed_limit'"},
      {R"("zones": [{"name": "z", "kind": "keepout", "region": [0, 0, 1, 1], "speed_limit": 1}])",
       "found a 'speed_limit' of a keepout zone"},
      {R"("zones": [{"name": "z", "kind": "keepout", "region": [0, 0, 1, 1]},
                    {"name": "z", "kind": "keepout", "region": [0, 0, 1, 1]}])",
       "s.json:3:30: error: found the zone 'z' again"},
      {R"("zones": [{"name": "z", "kind": "cleaning", "region": [0, 0, 900, 900]}])", "of more than 10000 m^2"},
      {R"("events": [{"at": 1, "lane": ["a", "d"], "closed": true}])", "found no lane between 'a' and 'd'"},
      {R"("events": [{"at": 1, "lane": ["a", "b"]}])", "expected one of 'closed' and 'speed_limit'"},
      {R"("events": [{"at": 1, "zone": "wet", "on": true}])", "s.json:2:30: error: found no zone 'wet'"},
      {R"("events": [{"at": 1, "door": "gate", "opening": 1}])", "found no door 'gate'"},
      {R"("events": [{"at": 1, "lift": "up", "floor": "L1"}])", "found no lift 'up'"},
      {R"("events": [{"at": 1, "door": "gate", "on": true}])", "found 'on' in an event of a door"},
      {R"("events": [{"at": 1}])", "found an event of nothing"},
      {R"("flows": [{"from": "a", "to": "nowhere", "per_hour": 1}])", "s.json:2:31: error: found no place 'nowhere'"},
      {R"("flows": [{"from": "a", "to": "a", "per_hour": 1}])", "found a flow to its own start"},
      {R"("flows": [{"from": "a", "to": "b", "per_hour": -1}])", "expected a number of goods from 0 to 36000"},
  };
  for (const auto& each : cases) EXPECT_THAT(error_of(each.keys), HasSubstr(each.text)) << each.keys;
}

// Chargers.

TEST(Chargers, TheRobotWithTheLeastEnergyComesFirst) {
  test::TemporaryFolder folder;
  folder.Write("s.building.yaml", R"(
coordinate_system: cartesian_meters
levels:
  G:
    vertices:
      - [0, 0, 0, a]
      - [0, 3, 0, b]
      - [0, 6, 0, c]
      - [4, 3, 0, junction]
      - [8, 3, 0, pad, {is_charger: [4, true]}]
      - [4, 0, 0, wait_1, {is_parking_spot: [4, true]}]
      - [4, 6, 0, wait_2, {is_parking_spot: [4, true]}]
    lanes:
      - [0, 3, {bidirectional: true}]
      - [1, 3, {bidirectional: true}]
      - [2, 3, {bidirectional: true}]
      - [3, 4, {bidirectional: true}]
      - [3, 5, {bidirectional: true}]
      - [3, 6, {bidirectional: true}]
)");
  folder.Write("w.inc", R"(
define cart position( size [0.4 0.4 0.4] drive "diff" joules_capacity 10000 watts 1 mass 1 take_watts 500
  velocity_bounds [-1 1 0 0 0 0 -90 90] acceleration_bounds [-1 1 0 0 0 0 -180 180] )
define station model( size [0.4 0.4 0.4] joules -1 give_watts 500 obstacle_return 0 ))");
  const auto robot = [](const std::string& name, double y, double kjoules) {
    return R"({"name": ")" + name + R"(", "model": "cart", "pose": [0, )" + std::to_string(y) +
           R"(, 0, 0], "properties": {"joules": )" + std::to_string(1000.0 * kjoules) +
           R"(}, "controller": {"name": "lanes", "parameters": {"charge_below": 0.5, "charge_to": 0.9}}})";
  };
  Simulation run = ValueOf(Simulation::Load(folder.Write(
      "s.json", R"({"world": "s.building.yaml", "include": ["w.inc"], "robots": [)" + robot("low", 0, 2.5) + ", " +
                    robot("lower", 3, 2.0) + ", " + robot("lowest", 6, 1.5) +
                    R"(], "models": [{"name": "station", "model": "station", "pose": [8, 3.3, 0, 0]}]})")));
  std::vector<std::string> order;
  std::set<std::uint32_t> waited_at;
  for (int i = 0; i < 4000; ++i) {
    run.Step();
    std::vector<RobotId> at_charger;
    for (const ChargingRobot& row : run.state().charging_robots) {
      if (row.at_charger) {
        at_charger.push_back(row.robot);
      } else if (row.vertex) {
        waited_at.insert(*row.vertex);
      }
    }
    ASSERT_LE(at_charger.size(), 1U) << run.tick();
    if (at_charger.empty()) continue;
    const std::string& name = run.world().robot(at_charger[0]).name;
    if (order.empty() || order.back() != name) order.push_back(name);
  }
  EXPECT_THAT(order, testing::ElementsAre("lowest", "lower", "low"));
  EXPECT_EQ(waited_at.size(), 2U) << "both others have a place of their own";
  EXPECT_TRUE(run.state().charging_robots.empty());
}

// Goods.

TEST(Goods, AreBroughtByTheNearestFreeRobotAndCounted) {
  test::TemporaryFolder folder;
  folder.Write("s.building.yaml", R"(
coordinate_system: cartesian_meters
levels:
  G:
    vertices:
      - [0, 0, 0, near, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, r1]}]
      - [10, 0, 0, far, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, r2]}]
      - [2, 0, 0, store]
      - [6, 0, 0, line]
      - [4, 3, 0, siding]
    lanes:
      - [0, 2, {bidirectional: true}]
      - [2, 3, {bidirectional: true}]
      - [3, 1, {bidirectional: true}]
      - [2, 4, {bidirectional: true}]
      - [4, 3, {bidirectional: true}]
)");
  const auto load = [&](const std::string& flow) {
    return ValueOf(Simulation::Load(
        folder.Write("s.json", R"({"world": "s.building.yaml", "seed": 3, "robots": [)" +
                                   OnLanes("r1", R"({"goods": true, "planned": true})") + ", " +
                                   OnLanes("r2", R"({"goods": true, "planned": true})") +
                                   R"(], "flows": [{"from": "store", "to": "line", )" + flow + "}]}")));
  };
  Simulation one = load(R"("per_hour": 0, "stock": 1, "due": 5)");
  std::vector<std::string> told;
  for (int i = 0; i < 600; ++i) {
    one.Step();
    if (i == 5) {
      ASSERT_EQ(one.state().jobs.size(), 1U);
      ASSERT_TRUE(one.state().jobs[0].robot.has_value());
      EXPECT_EQ(one.world().robot(*one.state().jobs[0].robot).name, "r1");
    }
    for (const Event& event : one.events()) {
      if (event.type == EventType::kGoodsLoaded || event.type == EventType::kDelivered) {
        told.push_back(std::string(NameOf(event.type)) + " " + one.world().robot(event.robot.value()).name);
      }
    }
  }
  EXPECT_THAT(told, testing::ElementsAre("goods_loaded r1", "delivered r1"));
  EXPECT_TRUE(one.state().jobs.empty());
  EXPECT_EQ(one.state().flows[0].delivered, 1U);
  EXPECT_EQ(one.state().flows[0].late, 1U);
  EXPECT_GT(one.state().flows[0].lateness, 50U);

  Simulation many = load(R"("per_hour": 90, "due": 600, "room": 5)");
  many.Step(18000);
  const FlowState& flow = many.state().flows[0];
  EXPECT_GT(flow.arrived + flow.refused, 20U);
  EXPECT_GT(flow.delivered, 20U);
  EXPECT_EQ(flow.delivered + many.state().jobs.size(), flow.arrived);
  Simulation again = load(R"("per_hour": 90, "due": 600, "room": 5)");
  again.Step(18000);
  EXPECT_EQ(StateHash(again.state()), StateHash(many.state()));
}

// Cleaning.

TEST(Cleaning, CountsTheCellsOnWhichARobotWas) {
  Simulation run = TwoWays(R"(, "zones": [{"name": "floor", "kind": "cleaning", "region": [2, -1, 6, 1]}])");
  const ZoneDescription& zone = run.world().zones[0];
  EXPECT_EQ(CountCells(zone), 800U);
  EXPECT_TRUE(Travel(run, 600).has_arrived);
  const ModelDescription& body = run.world().model(run.world().robots[0].root);
  const double expected = 4.0 * body.size_y / (kCoverageCell * kCoverageCell);
  EXPECT_NEAR(run.state().zones[0].covered, expected, 0.3 * expected);
  std::size_t bits = 0;
  const CoverageGrid grid = CoverageGrids(run.world())[0];
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      const bool is_covered = IsCovered(run.state(), grid, column, row);
      bits += is_covered ? 1 : 0;
      if (is_covered) {
        EXPECT_LT(std::fabs(grid.MiddleOf(column, row).y()), 0.5);
      }
    }
  }
  EXPECT_EQ(bits, run.state().zones[0].covered);
}

// The workshop of the worlds, for an hour: three robots bring goods, share a charger, and heed a floor that is wet for
// a while.
TEST(Workshop, RunsForAnHourWithoutAWord) {
  const std::string file = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites/workshop.json";
  Simulation run = ValueOf(Simulation::Load(file));
  const ZoneDescription wet = run.world().zones[*FindZone(run.world(), "wet floor")];
  std::vector<int> standing(run.world().robots.size(), 0);
  std::set<std::size_t> charged;
  for (int i = 0; i < 36000; ++i) {
    run.Step();
    for (const Event& event : run.events()) EXPECT_NE(event.type, EventType::kOutOfEnergy) << run.tick();
    for (std::size_t r = 0; r < standing.size(); ++r) {
      const RobotState& robot = run.state().robots[r];
      const bool has_work = std::any_of(run.state().jobs.begin(), run.state().jobs.end(),
                                        [&](const Job& job) { return job.robot == RobotId(r); });
      standing[r] = has_work && robot.twist.IsZero() ? standing[r] + 1 : 0;
      ASSERT_LT(standing[r], 3600) << run.tick() << ": " << run.world().robots[r].name;
      // One that is on its way there when the floor becomes wet drives on.
      if (run.tick() > 6200 && run.tick() <= 9000) {
        EXPECT_FALSE(IsInZone(run.world(), wet, robot.X_WR.translation(), 0.0)) << run.tick();
      }
    }
    for (const ChargingRobot& row : run.state().charging_robots) {
      if (row.at_charger) charged.insert(row.robot.index());
    }
  }
  EXPECT_EQ(charged.size(), 3U);
  for (std::size_t i = 0; i < run.state().flows.size(); ++i) {
    const FlowState& flow = run.state().flows[i];
    EXPECT_GT(flow.delivered, 3U) << run.world().flows[i].name;
    EXPECT_LE(flow.arrived - flow.delivered, 6U) << run.world().flows[i].name;
    EXPECT_EQ(flow.refused, 0U);
  }
  const std::size_t hall = *FindZone(run.world(), "hall");
  const double share =
      static_cast<double>(run.state().zones[hall].covered) / static_cast<double>(CountCells(run.world().zones[hall]));
  EXPECT_GT(share, 0.08);
  EXPECT_LT(share, 0.5);
}

}  // namespace
}  // namespace troupe
