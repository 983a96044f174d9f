// Zones: one drawing of them for masks of Nav2, robots that search their ways or are on lanes, and expectations.
#include "common/model/zones.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "common/spatial/occupancy_grid.h"
#include "common/spatial/robot_ways.h"
#include "common/spatial/scene.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "tests/worldfile/scenario_run.h"
#include "troupe/expectation.h"
#include "worldfile/load_world.h"
#include "worldfile/map/zone_mask.h"
#include "worldfile/sites/building_text.h"
#include "worldfile/sites/lif_json.h"
#include "worldfile/sites/opentcs_xml.h"

namespace troupe {
namespace {

using test::ValueOf;
using testing::ElementsAre;
using testing::HasSubstr;

// A hall of 12 m x 8 m with a wall in its middle, open at both ends, and a rover on its left.
constexpr const char* kZoneHall = R"(
model ( name "up" size [12.4 0.2 1] pose [0 4.1 0 0] )
model ( name "down" size [12.4 0.2 1] pose [0 -4.1 0 0] )
model ( name "right" size [0.2 8.4 1] pose [6.1 0 0 0] )
model ( name "left" size [0.2 8.4 1] pose [-6.1 0 0 0] )
model ( name "middle" size [0.2 4 1] pose [0 0 0 0] )
define rover position ( size [0.5 0.4 0.3] drive "diff" localization "gps" )
)";

class Zones : public ::testing::Test {
 protected:
  // A scenario in the hall with a robot from (-3, -1) to a point, and more keys.
  std::string Scenario(const std::string& to, const std::string& more, const std::string& name = "s.json") {
    folder_.Write("hall.world", kZoneHall);
    return folder_.Write(name, R"({"world": "hall.world", "robots": [{"model": "rover", "name": "r",
      "pose": [-3, -1, 0, 0], "controller": {"name": "go_to", "parameters": {"plan": true, "waypoints": [)" +
                                   to + "]}}}]" + more + "}");
  }
  LoadedWorld Load(const std::string& to, const std::string& more) { return ValueOf(LoadWorld(Scenario(to, more))); }
  std::string ErrorOf(const std::string& more) {
    const Result<LoadedWorld> loaded = LoadWorld(Scenario("[3, 0]", more));
    return loaded.ok() ? "" : loaded.error().ToString();
  }
  // The value of an expectation's monitor at the end of a run of so many ticks.
  static bool Holds(const LoadedWorld& loaded, const std::string& text, int ticks) {
    Simulation run = ValueOf(Simulation::Create(loaded.world));
    Monitor monitor(ValueOf(Expectation::Parse(text, {run.world(), loaded.regions})));
    for (int i = 0; i < ticks; ++i) {
      run.Step();
      EXPECT_TRUE(monitor.Push(run).ok());
    }
    monitor.Finish();
    return monitor.verdict() == Verdict::kTrue;
  }
  static OccupancyGrid Cells() {
    OccupancyGrid grid;
    grid.resolution = 0.1;
    grid.origin_x = -6.0;
    grid.origin_y = -4.0;
    grid.width = 120;
    grid.height = 80;
    return grid;
  }

  test::TemporaryFolder folder_;
};

// Masks.

TEST_F(Zones, OfAMaskGiveTheSameMaskAgain) {
  const LoadedWorld drawn = Load("[3, 0]", R"(, "zones": [
    {"name": "bend", "kind": "keepout", "region": [[-5, -3], [-2, -3], [-2, -2], [-4.1, -2], [-4.1, 1.3], [-5, 1.3]]},
    {"name": "wedge", "kind": "keepout", "region": [[2, 1], [4.3, 1.2], [3, 3.4]]},
    {"name": "slow", "kind": "speed", "speed_limit": 0.25, "region": [-1, -4, 1, 4]},
    {"name": "slower", "kind": "speed", "speed_limit": 0.1, "region": [[0, -2], [2, -2], [1, 0.7]]},
    {"name": "off", "kind": "keepout", "region": [4, 3, 5, 4], "on": false}])");
  std::vector<std::string> masks;
  for (const ZoneKind kind : {ZoneKind::kKeepout, ZoneKind::kSpeed}) {
    const std::string name = NameOf(kind);
    const ZoneMask mask = MakeZoneMask(drawn.world, kind, 0.0, Cells(), name + ".pgm");
    folder_.Write(name + ".pgm", mask.image);
    folder_.Write(name + ".yaml", mask.yaml);
    masks.push_back(mask.image);
    EXPECT_EQ(mask.multiplier, kind == ZoneKind::kSpeed ? 0.01 : 1.0);
  }
  const LoadedWorld read = Load("[3, 0]", R"(, "zones": [{"name": "no", "kind": "keepout", "mask": "keepout.yaml"},
    {"name": "slow", "kind": "speed", "mask": "speed.yaml"}])");
  std::vector<std::string> names;
  for (const ZoneDescription& zone : read.world.zones) names.push_back(zone.name);
  EXPECT_THAT(names, ElementsAre("no.1", "no.2", "slow.1", "slow.2"));
  EXPECT_EQ(read.world.zones[2].speed_limit, 0.1);
  EXPECT_EQ(read.world.zones[3].speed_limit, 0.25);
  EXPECT_THAT(read.files, testing::Contains(HasSubstr("keepout.yaml")));
  EXPECT_EQ(MakeZoneMask(read.world, ZoneKind::kKeepout, 0.0, Cells(), "").image, masks[0]);
  EXPECT_EQ(MakeZoneMask(read.world, ZoneKind::kSpeed, 0.0, Cells(), "").image, masks[1]);
}

TEST_F(Zones, OfAMaskWithHolesAndCornersThatTouchCoverItsCells) {
  // Two rings, one in the other, and cells that touch at their corners alone.
  const std::string rows[] = {"#########.", "#.......#.", "#.#####.#.", "#.#...#.#.", "#.#.#.#.#.",
                              "#.#...#.#.", "#.#####.#.", "#.......#.", "#########.", ".........#"};
  std::string image = "P2 10 10 255\n";
  std::size_t occupied = 0;
  for (const std::string& row : rows) {
    for (const char c : row) {
      image += c == '#' ? "0 " : "254 ";
      occupied += c == '#' ? 1 : 0;
    }
  }
  folder_.Write("m.pgm", image);
  folder_.Write(
      "m.yaml",
      "image: m.pgm\nresolution: 0.5\norigin: [-2, -3, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n");
  const LoadedWorld read = Load("[3, 0]", R"(, "zones": [{"name": "no", "kind": "keepout", "mask": "m.yaml"}])");
  std::size_t found = 0;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) {
      const Vec2 center(-2.0 + 0.5 * (x + 0.5), -3.0 + 0.5 * (y + 0.5));
      const auto count = std::count_if(read.world.zones.begin(), read.world.zones.end(),
                                       [&](const auto& zone) { return IsInZone(read.world, zone, center, 0.0); });
      EXPECT_EQ(count, rows[9 - y][static_cast<std::size_t>(x)] == '#' ? 1 : 0) << x << " " << y;
      found += static_cast<std::size_t>(count);
    }
  }
  EXPECT_EQ(found, occupied);
}

// Rings, pinches and single cells of all forms.
TEST_F(Zones, OfRandomMasksGiveTheSameMasksAgain) {
  OccupancyGrid cells;
  cells.resolution = 0.25;
  cells.origin_x = -2.0;
  cells.origin_y = 1.0;
  cells.width = 11;
  cells.height = 9;
  std::uint64_t chance = 7;
  for (int mask = 0; mask < 60; ++mask) {
    std::string image = "P5\n11 9\n255\n";
    for (int i = 0; i < 99; ++i) {
      chance = chance * 6364136223846793005U + 1442695040888963407U;
      image += (chance >> 60) < static_cast<std::uint64_t>(4 + mask % 10) ? '\0' : '\xff';
    }
    folder_.Write("m.pgm", image);
    folder_.Write("m.yaml",
                  "image: m.pgm\nmode: scale\nresolution: 0.25\norigin: [-2, 1, 0]\nnegate: 0\noccupied_thresh: "
                  "1\nfree_thresh: 0\n");
    const LoadedWorld read = Load("[3, 0]", R"(, "zones": [{"name": "no", "kind": "keepout", "mask": "m.yaml"}])");
    EXPECT_EQ(MakeZoneMask(read.world, ZoneKind::kKeepout, 0.0, cells, "").image, image) << mask;
  }
}

TEST_F(Zones, OfASpeedMaskInPercentAreLimitsOfItsMaximum) {
  folder_.Write("m.pgm", "P2 3 1 255\n20 0 100\n");
  folder_.Write(
      "m.yaml",
      "image: m.pgm\nmode: raw\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 1\nfree_thresh: 0\n");
  const LoadedWorld read = Load("[3, 0]", R"(, "zones": [{"name": "slow", "kind": "speed", "mask": "m.yaml",
    "base": 100, "multiplier": -0.5, "speed_limit": 0.5}])");
  ASSERT_EQ(read.world.zones.size(), 2u);
  EXPECT_DOUBLE_EQ(read.world.zones[0].speed_limit, 0.45);  // 90 %
  EXPECT_DOUBLE_EQ(read.world.zones[1].speed_limit, 0.25);
}

TEST_F(Zones, WithFaultsAreNamed) {
  folder_.Write("m.pgm", "P2 1 1 255\n0\n");
  folder_.Write(
      "m.yaml",
      "image: m.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n");
  const struct {
    const char* zone;
    const char* text;
  } cases[] = {
      {R"("kind": "keepout")", "neither of 'region' and 'mask'"},
      {R"("kind": "keepout", "region": [0, 0, 1, 1], "mask": "m.yaml")", "both of 'region' and 'mask'"},
      {R"("kind": "release", "mask": "m.yaml")", "found a 'mask' of a release zone"},
      {R"("kind": "keepout", "mask": "none.yaml")", "none.yaml"},
      {R"("kind": "keepout", "mask": "m.yaml", "base": 1)", "found 'base' of a zone that is no speed mask"},
      {R"("kind": "speed", "mask": "m.yaml", "multiplier": -1)", "found a limit of -100 m/s"},
      {R"("kind": "one_way", "region": [0, 0, 1, 1])", "without 'heading'"},
      {R"("kind": "one_way", "heading": 0, "on": false, "region": [0, 0, 1, 1])", "found a one_way zone that is off"},
      {R"("kind": "keepout", "heading": 0, "region": [0, 0, 1, 1])", "found a 'heading' of a keepout zone"},
  };
  for (const auto& each : cases) {
    EXPECT_THAT(ErrorOf(R"(, "zones": [{"name": "z", )" + std::string(each.zone) + "}]"), HasSubstr(each.text))
        << each.zone;
  }
  EXPECT_THAT(ErrorOf(R"(, "zones": [{"name": "z", "kind": "one_way", "heading": 0, "region": [0, 0, 1, 1]}],
    "events": [{"at": 1, "zone": "z", "on": false}])"),
              HasSubstr("which is on for the whole run"));
}

// Planned ways.

// The way to (3, -1) is through the lower end of the wall, unless that is closed.
constexpr const char* kLowerEnd = R"("region": [-1, -4, 1, -2])";

std::string LowerEnd(const std::string& kind) {
  return R"(, "zones": [{"name": "lower", "kind": )" + kind + ", " + kLowerEnd + "}]";
}

TEST_F(Zones, ThatAreKeptOutOfAreGoneAroundByTheWholeBody) {
  const LoadedWorld loaded = Load("[3, -1]", LowerEnd(R"("keepout")"));
  EXPECT_TRUE(Holds(loaded, "always not in(r, lower)", 400));
  ScenarioRun run(loaded.world);
  double nearest = 10.0;
  for (int i = 0; i < 400; ++i) {
    run.Run(1);
    const Vec2 at = run["r"].X_WR.translation();
    const Vec2 beside(std::max(std::fabs(at.x()) - 1.0, 0.0), std::max(at.y() + 2.0, 0.0));
    nearest = std::min(nearest, beside.norm());
  }
  EXPECT_GT(nearest, 0.2);  // half its width
  EXPECT_LT((run["r"].X_WR.translation() - Vec2(3.0, -1.0)).norm(), 0.1);
  // Without the zone it takes the shorter way.
  const LoadedWorld open = Load("[3, -1]", LowerEnd(R"("keepout", "on": false)"));
  EXPECT_FALSE(Holds(open, "always not in(r, lower)", 400));
}

TEST_F(Zones, ThatAreKeptOutOfAreGoneAroundByTheWaysThatViewersSee) {
  const Vec2 goal(3.0, -1.0);
  const auto lowest = [&](const std::string& kind) {
    const ScenarioRun run(Load("[3, -1]", LowerEnd(kind)).world);
    const std::vector<Vec2> way = FindWays(run.scene(), run.state(), RobotId(0), std::span(&goal, 1));
    EXPECT_LT((way.back() - goal).norm(), 0.1);
    double y = 10.0;
    for (const Vec2& point : way) y = std::min(y, point.y());
    return y;
  };
  EXPECT_GT(lowest(R"("keepout")"), -1.5);
  EXPECT_GT(lowest(R"("one_way", "heading": 180)"), -1.5);
  EXPECT_LT(lowest(R"("keepout", "on": false)"), -2.0);
}

TEST_F(Zones, ThatAreKeptOutOfAreLeftByARobotInThem) {
  const LoadedWorld loaded =
      Load("[3, -1]", R"(, "zones": [{"name": "here", "kind": "keepout", "region": [-4, -2, -2, 0]}])");
  ScenarioRun run(loaded.world);
  run.Run(500);
  EXPECT_LT((run["r"].X_WR.translation() - Vec2(3.0, -1.0)).norm(), 0.1);
}

TEST_F(Zones, ThatCloseAllWaysAreTheReasonToGiveAGoalUp) {
  const LoadedWorld loaded =
      Load("[3, -1]", R"(, "zones": [{"name": "all", "kind": "keepout", "region": [-1, -4, 1, 4]}])");
  ScenarioRun run(loaded.world);
  run.Run(50);
  std::string said;
  for (const Event& event : run.events()) {
    if (event.type == EventType::kSaid) said += event.detail;
  }
  EXPECT_THAT(said, HasSubstr("no way leads there that the zones allow"));
}

TEST_F(Zones, OfASpeedSlowThoseThatSearchTheirWays) {
  const LoadedWorld loaded = Load("[3, -1]", LowerEnd(R"("speed", "speed_limit": 0.1)"));
  EXPECT_TRUE(Holds(loaded, "always (in(r, lower) -> speed(r) <= 0.11)", 700));
  EXPECT_TRUE(Holds(loaded, "eventually speed(r) > 0.2", 100));
  EXPECT_TRUE(Holds(loaded, "eventually in(r, lower)", 700));
}

TEST_F(Zones, OfOneWayAreDrivenThroughAlongTheirHeadingAlone) {
  const LoadedWorld along = Load("[3, -1]", LowerEnd(R"("one_way", "heading": 0)"));
  EXPECT_TRUE(Holds(along, "eventually in(r, lower)", 400));
  const LoadedWorld against = Load("[3, -1]", LowerEnd(R"("one_way", "heading": 180)"));
  EXPECT_TRUE(Holds(against, "always not in(r, lower)", 400));
  ScenarioRun run(against.world);
  run.Run(500);
  EXPECT_LT((run["r"].X_WR.translation() - Vec2(3.0, -1.0)).norm(), 0.1);
}

TEST_F(Zones, ToBeReleasedAreWaitedForAndEnteredOnceTheyAreOff) {
  const LoadedWorld loaded =
      Load("[3, -1]", LowerEnd(R"("release")") + R"(, "events": [{"at": 30, "zone": "lower", "on": false}])");
  ScenarioRun run(loaded.world);
  run.Run(280);
  const Vec2 waits = run["r"].X_WR.translation();
  EXPECT_FALSE(IsInZone(loaded.world, loaded.world.zones[0], waits, 0.0));
  EXPECT_LT((waits - Vec2(-1.0, -2.0)).norm(), 1.5);
  run.Run(300);
  EXPECT_LT((run["r"].X_WR.translation() - Vec2(3.0, -1.0)).norm(), 0.1);
}

// Lanes.

constexpr const char* kCrossing = R"(
coordinate_system: cartesian_meters
levels:
  G:
    vertices:
      - [0, 0, 0, a]
      - [4, 0, 0, b]
      - [4, 3, 0, c]
      - [0, 3, 0, d]
    lanes:
      - [0, 1, {bidirectional: [4, true], graph_idx: [2, 0]}]
      - [1, 2, {bidirectional: [4, true], graph_idx: [2, 0]}]
      - [2, 3, {bidirectional: [4, true], graph_idx: [2, 0]}]
      - [3, 0, {bidirectional: [4, true], graph_idx: [2, 0]}]
)";

std::string OnCrossing(const std::string& zones, const std::string& planned = "true") {
  return R"({"world": "s.building.yaml", "robots": [{"model": "TinyRobot", "name": "r", "pose": [0, 0, 0, 0],
    "controller": {"name": "lanes", "parameters": {"places": ["b", "a"], "wait": 1, "planned": )" +
         planned + R"(}}}], "zones": [)" + zones + "]}";
}

TEST(ZonesOnLanes, OfOneWayDirectTheLanesThroughThem) {
  test::TemporaryFolder folder;
  folder.Write("s.building.yaml", kCrossing);
  const LoadedWorld loaded = ValueOf(LoadWorld(folder.Write(
      "s.json", OnCrossing(R"({"name": "w", "kind": "one_way", "heading": 180, "region": [1, -1, 3, 1]})"))));
  const LaneGraph& graph = loaded.world.lane_graphs[0];
  EXPECT_TRUE(Validate(loaded.world).ok());
  std::set<std::string> names;
  for (const WholeLane& lane : WholeLanesOf(graph)) {
    names.insert(graph.vertices[lane.start].name + graph.vertices[lane.end].name);
    if (graph.vertices[lane.start].name == "b" && graph.vertices[lane.end].name == "a") {
      EXPECT_FALSE(graph.lanes[lane.parts.front()].is_bidirectional);
    }
  }
  EXPECT_TRUE(names.contains("ba"));
  EXPECT_FALSE(names.contains("ab"));
  // There it goes round, and straight back.
  Simulation run = ValueOf(Simulation::Create(loaded.world));
  double highest = 0.0;
  while (run.tick() < 2000 && (run.state().robots[0].X_WR.translation() - Vec2(4.0, 0.0)).norm() > 0.3) {
    run.Step();
    highest = std::max(highest, run.state().robots[0].X_WR.y);
  }
  EXPECT_GT(highest, 2.5);
  while (run.tick() < 4000 && run.state().robots[0].X_WR.x > 0.3) {
    run.Step();
    EXPECT_LT(run.state().robots[0].X_WR.y, 0.6);
  }
  EXPECT_LT(run.tick(), 4000u);
}

// Whole lanes of the first graph: their ends, the facing of robots, and whether they lead in both directions.
using LaneFacts = std::tuple<std::string, std::string, LaneFacing, bool>;
std::vector<LaneFacts> LanesIn(const LoadedWorld& loaded) {
  const LaneGraph& graph = loaded.world.lane_graphs.at(0);
  std::vector<LaneFacts> lanes;
  for (const WholeLane& whole : WholeLanesOf(graph)) {
    const Lane& lane = graph.lanes[whole.parts.front()];
    lanes.emplace_back(graph.vertices[whole.start].name, graph.vertices[whole.end].name, lane.facing,
                       lane.is_bidirectional);
  }
  std::sort(lanes.begin(), lanes.end());
  return lanes;
}

TEST(ZonesOnLanes, OfOneWayCountInExportedLanes) {
  test::TemporaryFolder folder;
  std::string building = kCrossing;
  // One that becomes one lane back, with the robot's back ahead; and one that is left out.
  const std::string both_ways = "[0, 1, {bidirectional: [4, true], ";
  building.replace(building.find(both_ways), both_ways.size(),
                   "[0, 1, {bidirectional: [4, true], orientation: [1, forward], ");
  const std::string forth = "[2, 3, {bidirectional: [4, true]";
  building.replace(building.find(forth), forth.size(), "[2, 3, {bidirectional: [4, false]");
  folder.Write("s.building.yaml", building);
  const LoadedWorld loaded = ValueOf(LoadWorld(
      folder.Write("s.json", OnCrossing(R"({"name": "w", "kind": "one_way", "heading": 180, "region": [1, -1, 3, 1]},
                              {"name": "v", "kind": "one_way", "heading": 0, "region": [1, 2, 3, 4]})"))));
  const std::vector<LaneFacts> lanes = LanesIn(loaded);
  EXPECT_THAT(
      lanes, ElementsAre(LaneFacts("b", "a", LaneFacing::kBackward, false), LaneFacts("b", "c", LaneFacing::kAny, true),
                         LaneFacts("d", "a", LaneFacing::kAny, true)));
  const std::string layout = folder.Write("l.lif.json", LayoutText(*loaded.site, "2026-01-01T00:00:00Z"));
  EXPECT_EQ(LanesIn(ValueOf(LoadWorld(layout))), lanes);
  EXPECT_EQ(LanesIn(ValueOf(LoadWorld(folder.Write("b.building.yaml", BuildingText(*loaded.site))))), lanes);
  const std::string plant = PlantModelText(*loaded.site, {});
  EXPECT_THAT(plant, HasSubstr("sourcePoint=\"b\" destinationPoint=\"a\""));
  EXPECT_THAT(plant, testing::Not(HasSubstr("sourcePoint=\"a\" destinationPoint=\"b\"")));
  // The file's own lanes stay as they are.
  EXPECT_EQ(LanesIn(ValueOf(LoadWorld(folder.Path("s.building.yaml")))).size(), 4U);
}

TEST(ZonesOnLanes, ToBeReleasedAreWaitedFor) {
  test::TemporaryFolder folder;
  folder.Write("s.building.yaml", kCrossing);
  const LoadedWorld loaded = ValueOf(LoadWorld(
      folder.Write("s.json", OnCrossing(R"({"name": "w", "kind": "release", "region": [1, -1, 3, 1]})", "false"))));
  Simulation run = ValueOf(Simulation::Create(loaded.world));
  for (int i = 0; i < 300; ++i) run.Step();
  EXPECT_LT(run.state().robots[0].X_WR.x, 1.0);
  ASSERT_TRUE(run.AddInput({{}, ZoneOrder{0, false}}).ok());
  double farthest = 0.0;
  for (int i = 0; i < 300; ++i) {
    run.Step();
    farthest = std::max(farthest, run.state().robots[0].X_WR.x);
  }
  EXPECT_GT(farthest, 3.5);
}

}  // namespace
}  // namespace troupe
