// Route graphs of Nav2 (GeoJSON): lanes from them, their faults, and the way back.
#include "tests/support/values.h"
#include "tests/worldfile/scenario_run.h"
#include "tests/worldfile/world_folder.h"
#include "worldfile/sites/route_graph.h"

namespace troupe {
namespace {

using test::ValueOf;
using testing::HasSubstr;

std::string Node(int id, double x, double y, const std::string& more = "") {
  return R"({"type": "Feature", "properties": {"id": )" + std::to_string(id) + R"(, "frame": "map")" + more +
         R"(}, "geometry": {"type": "Point", "coordinates": [)" + std::to_string(x) + ", " + std::to_string(y) + "]}}";
}

std::string RouteEdge(int id, int from, int to, const std::string& more = "") {
  return R"({"type": "Feature", "properties": {"id": )" + std::to_string(id) + R"(, "startid": )" +
         std::to_string(from) + R"(, "endid": )" + std::to_string(to) + more +
         R"(}, "geometry": {"type": "MultiLineString", "coordinates": [[[0, 0], [1, 1]]]}})";
}

std::string Features(const std::vector<std::string>& features) {
  std::string text = R"({"type": "FeatureCollection", "features": [)";
  for (std::size_t i = 0; i < features.size(); ++i) text += (i > 0 ? ",\n" : "\n") + features[i];
  return text + "]}";
}

const std::string kGraph = Features({
    RouteEdge(10, 0, 1, R"(, "metadata": {"abs_speed_limit": 0.4})"),
    RouteEdge(11, 1, 0, R"(, "metadata": {"abs_speed_limit": 0.4})"),
    RouteEdge(12, 1, 2),
    Node(0, 0.0, 0.0, R"(, "metadata": {"name": "home", "charger": true})"),
    Node(1, 4.0, 0.0),
    Node(2, 4.0, 3.0, R"(, "metadata": {"name": "shelf", "dock": "s1"})"),
});

TEST(RouteGraphs, AreLanesBetweenPlaces) {
  const Site site = ValueOf(ReadRouteGraphText(kGraph, "g.geojson"));
  ASSERT_EQ(site.levels.size(), 1u);
  const SiteLevel& level = site.levels[0];
  ASSERT_EQ(level.vertices.size(), 3u);
  EXPECT_EQ(level.vertices[0].name, "home");
  EXPECT_TRUE(level.vertices[0].is_charger);
  EXPECT_EQ(level.vertices[1].name, "1");
  EXPECT_EQ(level.vertices[2].dock, "s1");
  ASSERT_EQ(level.lanes.size(), 2u);
  EXPECT_TRUE(level.lanes[0].is_bidirectional);
  EXPECT_EQ(level.lanes[0].speed_limit, 0.4);
  EXPECT_FALSE(level.lanes[1].is_bidirectional);
  EXPECT_TRUE(site.warnings.empty());
}

TEST(RouteGraphs, OfLanesGiveTheSameLanesAgain) {
  test::TemporaryFolder folder;
  const LoadedWorld first = ValueOf(LoadWorld(folder.Write("a.geojson", kGraph)));
  ASSERT_EQ(first.world.lane_graphs.size(), 1u);
  const std::string text = RouteGraphText(first.world.lane_graphs[0], 0.0);
  const LoadedWorld second = ValueOf(LoadWorld(folder.Write("b.geojson", text)));
  EXPECT_EQ(second.world.lane_graphs, first.world.lane_graphs);
  EXPECT_EQ(RouteGraphText(second.world.lane_graphs[0], 0.0), text);
}

TEST(RouteGraphs, AreDrivenAlong) {
  test::TemporaryFolder folder;
  folder.Write("g.geojson", kGraph);
  const LoadedWorld loaded = ValueOf(LoadWorld(folder.Write(
      "s.json", R"({"world": "g.geojson", "robots": [{"model": "TinyRobot", "name": "r", "pose": [0, 0, 0, 0],
        "controller": {"name": "lanes", "parameters": {"places": ["shelf"], "repeat": false}}}]})")));
  ScenarioRun run(loaded.world);
  run.Run(400);
  EXPECT_LT((run["r"].X_WR.translation() - Vec2(4.0, 3.0)).norm(), 0.2);
}

TEST(RouteGraphs, WithFaultsAreNamedWithTheirPlaces) {
  const struct {
    std::string text;
    const char* error;
  } cases[] = {
      {Features({Node(0, 0, 0), RouteEdge(1, 0, 7)}),
       "g.geojson:3:68: error: found the number 7 as 'features[1].properties.endid'"},
      {Features({Node(0, 0, 0), Node(0, 1, 1)}), "an id that no other node or edge has"},
      {Features({Node(0, 0, 0), RouteEdge(1, 0, 0)}), "another node than that of 'startid'"},
      {Features({Node(0, 1e9, 0)}), "features[0].geometry.coordinates[0]"},
      {Features({}), "found no node"},
      {"{}", "features"},
      {"[", "g.geojson:1:"},
      {Features({R"({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon"}})"}),
       "'Point', 'LineString'"},
  };
  for (const auto& each : cases) {
    const Result<Site> site = ReadRouteGraphText(each.text, "g.geojson");
    ASSERT_FALSE(site.ok()) << each.text;
    EXPECT_THAT(site.error().ToString(), HasSubstr(each.error));
  }
}

TEST(RouteGraphs, NameWhatHasNoEffect) {
  const Site site =
      ValueOf(ReadRouteGraphText(Features({Node(0, 0, 0, R"(, "frame2": 1, "operations": {})"), Node(1, 1, 0),
                                           RouteEdge(2, 0, 1, R"(, "cost": 3, "metadata": {"speed_limit": 50})"),
                                           RouteEdge(3, 1, 0, R"(, "cost": 1)")}),
                                 "g.geojson"));
  std::string warnings;
  for (const Warning& warning : site.warnings) warnings += warning.ToString() + "\n";
  EXPECT_THAT(warnings, HasSubstr("operations of nodes"));
  EXPECT_THAT(warnings, HasSubstr("'abs_speed_limit' is one in m/s"));
  EXPECT_THAT(warnings, HasSubstr("costs of edges"));
  EXPECT_EQ(site.warnings.size(), 3u);
}

}  // namespace
}  // namespace troupe
