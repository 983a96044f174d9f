// Layouts in LIF: their levels, lanes and places, their faults, and robots on them.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "robot-agent/controller/create_controller.h"
#include "tests/support/values.h"
#include "tests/worldfile/scenario_run.h"
#include "tests/worldfile/world_folder.h"
#include "worldfile/sites/lif_json.h"

namespace troupe {
namespace {

using test::ValueOf;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

std::string LayoutSites() {
  return std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites/";
}

// A layout of level `level` with nodes a at (0, 0) and b at (3, 4).
std::string LayoutOf(const std::string& edges, const std::string& more = "", const std::string& prefix = "",
                     const std::string& level = "ground") {
  return R"({"layoutId": ")" + prefix + R"(l", "layoutLevelId": ")" + level + R"(", "nodes": [
    {"nodeId": ")" +
         prefix + R"(a", "nodePosition": {"x": 0, "y": 0}},
    {"nodeId": ")" +
         prefix + R"(b", "nodePosition": {"x": 3, "y": 4}}],
    "edges": [)" +
         edges + "]" + more + "}";
}

std::string LayoutFile(const std::string& layouts) {
  return R"({"metaInformation": {"projectIdentification": "plant"}, "layouts": [)" + layouts + "]}";
}

Site ReadPlan(const std::string& layouts) {
  return ValueOf(ReadLayoutText(LayoutFile(layouts), "l.json"));
}

std::string LayoutEdge(const std::string& from, const std::string& to, const std::string& properties) {
  return R"({"startNodeId": ")" + from + R"(", "endNodeId": ")" + to + R"(", "vehicleTypeEdgeProperties": [)" +
         properties + "]}";
}

TEST(Layouts, EdgesToAndFroAreOneLaneOfEachVehicleType) {
  const Site site = ReadPlan(
      LayoutOf(LayoutEdge("a", "b", R"({"vehicleTypeId": "tug", "maxSpeed": 0.5})") + "," +
               LayoutEdge("b", "a", R"({"vehicleTypeId": "tug", "maxSpeed": 0.5}, {"vehicleTypeId": "fork"})")));
  EXPECT_EQ(site.name, "plant");
  ASSERT_EQ(site.levels.size(), 1u);
  EXPECT_EQ(site.levels[0].name, "ground");
  EXPECT_EQ(site.levels[0].vertices[1].name, "b");
  EXPECT_EQ(site.levels[0].vertices[1].position, Vec2(3.0, 4.0));
  const std::vector<SiteLane>& lanes = site.levels[0].lanes;
  ASSERT_EQ(lanes.size(), 2u);
  EXPECT_TRUE(lanes[0].is_bidirectional);
  EXPECT_EQ(lanes[0].speed_limit, 0.5);
  EXPECT_FALSE(lanes[1].is_bidirectional);
  EXPECT_EQ(lanes[1].graph, 1u);
  EXPECT_EQ(lanes[1].edge.start, 1u);
}

TEST(Layouts, OrientationsAreThoseAlongTheEdge) {
  const auto orientation = [](const std::string& value) {
    const Site site = ReadPlan(LayoutOf(LayoutEdge("a", "b", R"({"vehicleTypeId": "t", )" + value + "}")));
    return site.levels[0].lanes[0].orientation;
  };
  EXPECT_EQ(orientation(R"("vehicleOrientation": 0)"), "forward");
  EXPECT_EQ(orientation(R"("vehicleOrientation": 3.1416, "orientationType": "TANGENTIAL")"), "backward");
  EXPECT_EQ(orientation(R"("vehicleOrientation": 180, "orientationType": "TANGENTIAL")"), "backward");
  EXPECT_EQ(orientation(R"("vehicleOrientation": 1.5708)"), "");
  EXPECT_EQ(orientation(R"("vehicleOrientation": 0.927, "orientationType": "GLOBAL")"), "forward");
  EXPECT_EQ(orientation(R"("vehicleOrientation": -2.214, "orientationType": "GLOBAL")"), "backward");
  EXPECT_EQ(orientation(R"("maxSpeed": 1)"), "");
  // The same heading on the way back: one lane.
  const Site site =
      ReadPlan(LayoutOf(LayoutEdge("a", "b", R"({"vehicleTypeId": "t", "vehicleOrientation": 3.1416})") + "," +
                        LayoutEdge("b", "a", R"({"vehicleTypeId": "t", "vehicleOrientation": 0})")));
  EXPECT_EQ(site.levels[0].lanes.size(), 1u);
}

TEST(Layouts, LayoutsOfOneLevelAreOneAndOthersAreAbove) {
  const Site site =
      ReadPlan(LayoutOf("") + "," + LayoutOf(LayoutEdge("a", "2b", ""), "", "2") + "," + LayoutOf("", "", "3", "roof"));
  ASSERT_EQ(site.levels.size(), 2u);
  EXPECT_EQ(site.levels[0].vertices.size(), 4u);
  EXPECT_EQ(site.levels[0].lanes.size(), 1u);
  EXPECT_EQ(site.levels[1].elevation, kLayoutStorey);
  ASSERT_EQ(site.warnings.size(), 1u);
  EXPECT_THAT(site.warnings[0].message, HasSubstr("found 2 levels, whose heights this file does not have"));
}

TEST(Layouts, FaultsHaveTheirPlace) {
  const auto error = [](const std::string& text) { return ReadLayoutText(text, "l.json").error().ToString(); };
  EXPECT_THAT(error("{\n  \"metaInformation\": {},\n  \"layouts\": 4\n}"),
              HasSubstr("l.json:3:14: error: found the number 4 as 'layouts', expected a list"));
  EXPECT_THAT(error(LayoutFile("")), HasSubstr("found no layout, expected at least one"));
  EXPECT_THAT(error(LayoutFile("7")), HasSubstr("found the number 7 as 'layouts[0]', expected an object"));
  EXPECT_THAT(error(LayoutFile(LayoutOf(LayoutEdge("a", "c", "")))),
              HasSubstr("found the string 'c' as 'layouts[0].edges[0].endNodeId', expected the id of a node"));
  EXPECT_THAT(error(LayoutFile(LayoutOf(R"({"startNodeId": "a"})"))),
              HasSubstr("found no 'endNodeId' in 'layouts[0].edges[0]', expected the id of a node"));
  EXPECT_THAT(error(LayoutFile(LayoutOf("") + "," + LayoutOf(""))),
              HasSubstr("found the string 'a' as 'layouts[1].nodes[0].nodeId', expected an id that no other node has"));
  EXPECT_THAT(error(LayoutFile(LayoutOf(LayoutEdge("a", "b", R"({"vehicleTypeId": "t", "maxSpeed": -1})")))),
              HasSubstr("maxSpeed', expected a number between 0 and"));
  EXPECT_THAT(error(LayoutFile(R"({"layoutId": "l", "nodes": [{"nodeId": "a", "nodePosition": {"x": "1", "y": 2}}]})")),
              HasSubstr("found the string '1' as 'layouts[0].nodes[0].nodePosition.x', expected a number"));
  EXPECT_THAT(
      error(LayoutFile(R"({"layoutId": "l", "nodes": [{"nodeId": "a"}]})")),
      HasSubstr("found no 'nodePosition' in 'layouts[0].nodes[0]', expected an object with the numbers x and y"));
  EXPECT_THAT(
      error(LayoutFile(LayoutOf("", R"(, "stations": [{"stationId": "s", "interactionNodeIds": ["a", 5]}])"))),
      HasSubstr("found the number 5 as 'layouts[0].stations[0].interactionNodeIds[1]', expected the id of a node"));
  EXPECT_THAT(error("{"), HasSubstr("l.json:1:"));
}

TEST(Layouts, OtherVersionsOfTheFormatAreNamed) {
  test::TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    const Result<LoadedWorld> loaded = LoadWorld(folder.Write("l.json", text));
    return loaded.ok() ? "" : loaded.error().ToString();
  };
  EXPECT_THAT(
      error(R"({"metaInformation": {"lifVersion": "2.0.0"}, "origins": []})"),
      HasSubstr(
          "l.json:1:36: error: found the string '2.0.0' as 'metaInformation.lifVersion', expected version 1 of LIF"));
  EXPECT_THAT(error(R"({"metaInformation": {"lifVersion": 3}, "layouts": []})"),
              HasSubstr("found the number 3 as 'metaInformation.lifVersion', expected version 1 of LIF"));
  EXPECT_THAT(
      error(R"({"origins": [{"originId": "O", "layouts": []}]})"),
      HasSubstr("l.json:1:2: error: found the key 'origins' of version 2 of LIF, expected 'layouts' of version 1"));
  EXPECT_THAT(error(R"({"metaInformation": {"lifVersion": "1.0.0"}})"),
              HasSubstr("found no 'layouts', expected a list"));
  const std::string nodes =
      R"({"nodeId": "a", "nodePosition": {"x": 0, "y": 0}}, {"nodeId": "b", "nodePosition": {"x": 1, "y": 0}})";
  EXPECT_THAT(error(LayoutFile(
                  R"({"layoutId": "l", "nodes": [)" + nodes +
                  R"(], "edges": [{"startNodeId": "a", "endNodeId": "b", "mobileRobotTypeEdgeProperties": []}]})")),
              HasSubstr("found the key 'mobileRobotTypeEdgeProperties' of version 2 of LIF, expected "
                        "'vehicleTypeEdgeProperties' of version 1"));
  for (const char* const version : {"1.0.0", "1", "0.11.0"}) {
    EXPECT_EQ(error(R"({"metaInformation": {"lifVersion": ")" + std::string(version) + R"("}, "layouts": [)" +
                    LayoutOf("") + "]}"),
              "")
        << version;
  }
}

TEST(Layouts, WhatIsNotFollowedIsNamedOnce) {
  const std::string curve =
      R"({"vehicleTypeId": "t", "trajectory": {"degree": 2, "knotVector": [0, 0, 0, 1, 1, 1], "controlPoints": [
         {"x": 0, "y": 0}, {"x": 3, "y": 0}, {"x": 3, "y": 4}]}})";
  const Site site = ReadPlan(
      LayoutOf(LayoutEdge("a", "b", curve) + "," + LayoutEdge("b", "a", curve) + "," + LayoutEdge("a", "3a", "")) +
      "," + LayoutOf("", "", "3", "roof"));
  std::vector<std::string> messages;
  for (const Warning& warning : site.warnings) messages.push_back(warning.message);
  EXPECT_THAT(messages, ElementsAre(HasSubstr("found a trajectory, which is not followed: lanes are straight"),
                                    HasSubstr("found an edge between two levels"), HasSubstr("found 2 levels")));
}

// What a building has in common with a layout is the same after an export.
TEST(Layouts, AreWrittenFromBuildings) {
  const Site site = *ValueOf(LoadWorld(LayoutSites() + "guesthouse.building.yaml")).site;
  const std::string text = LayoutText(site, "2026-01-01T00:00:00Z");
  const Site read = ValueOf(ReadLayoutText(text, "l.json"));
  EXPECT_EQ(read.name, "guesthouse");
  ASSERT_EQ(read.levels.size(), 2u);
  const auto lanes = [](const Site& of) {
    std::vector<std::string> lines;
    for (const SiteLevel& level : of.levels) {
      for (const SiteLane& lane : level.lanes) {
        const Vec2& a = level.vertices[lane.edge.start].position;
        const Vec2& b = level.vertices[lane.edge.end].position;
        lines.push_back(level.name + " " + std::to_string(lane.graph) + " " + std::to_string(a.x()) + "," +
                        std::to_string(a.y()) + " " + std::to_string(b.x()) + "," + std::to_string(b.y()) + " " +
                        lane.orientation + " " + std::to_string(lane.speed_limit) +
                        (lane.is_bidirectional ? " <>" : ""));
      }
    }
    return lines;
  };
  EXPECT_EQ(lanes(read), lanes(site));
  std::size_t docks = 0;
  std::size_t chargers = 0;
  for (const SiteVertex& vertex : read.levels[0].vertices) {
    docks += vertex.name == "pantry" && vertex.dock == "pantry_dock" ? 1 : 0;
    chargers += vertex.is_charger ? 1 : 0;
  }
  EXPECT_EQ(docks, 1u);
  EXPECT_EQ(chargers, 2u);
}

TEST(Layouts, AreFoundByTheirContent) {
  test::TemporaryFolder folder;
  EXPECT_TRUE(IsLayoutPath(folder.Write("any.json", LayoutFile(LayoutOf("")))));
  EXPECT_FALSE(IsLayoutPath(folder.Write("s.json", R"({"world": "layouts"})")));
  EXPECT_FALSE(IsLayoutPath(folder.Write("any.world", LayoutFile(LayoutOf("")))));
  EXPECT_FALSE(IsLayoutPath(folder.Path("none.json")));
  EXPECT_THAT(LoadWorld(folder.Write("bad.lif.json", "{\"layouts\": [}")).error().ToString(),
              HasSubstr("bad.lif.json:1"));
}

TEST(Layouts, AreWorldsOfRobotsOnLanes) {
  const LoadedWorld plan = ValueOf(LoadWorld(LayoutSites() + "warehouse.lif.json"));
  EXPECT_TRUE(plan.warnings.empty());
  EXPECT_THAT(plan.world.places,
              Contains(AllOf(testing::Field(&NamedPlace::name, "bay"),
                             testing::Field(&NamedPlace::tags, ElementsAre("ground", "charger", "dock:dock_b")))));
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  ScenarioRun run(ValueOf(LoadWorld(LayoutSites() + "warehouse_lanes.json", overrides)).world);
  int at_rack[2] = {0, 0};
  int at_end[2] = {0, 0};
  const auto is_near = [&](const char* name, double x, double y) {
    const RobotState& robot = run[name];
    return robot.twist.IsZero() && std::hypot(robot.X_WR.x - x, robot.X_WR.y - y) < 0.15;
  };
  for (int i = 0; i < 3000; ++i) {
    run.Run(1);
    at_rack[0] += is_near("tug_1", 0, 4) ? 1 : 0;
    at_rack[1] += is_near("fork_1", 0, 4) ? 1 : 0;
    at_end[0] += is_near("tug_1", 8, 4) ? 1 : 0;
    at_end[1] += is_near("fork_1", 12, 0) ? 1 : 0;
    // It backs into the bay.
    if (run["fork_1"].X_WR.x > 9.0 && std::fabs(run["fork_1"].twist.vx) > 0.1) {
      EXPECT_LT(std::cos(run["fork_1"].X_WR.heading), -0.9) << i;
    }
  }
  for (const int robot : {0, 1}) {
    EXPECT_GT(at_rack[robot], 50) << robot;
    EXPECT_GT(at_end[robot], 50) << robot;
  }
}

}  // namespace
}  // namespace troupe
