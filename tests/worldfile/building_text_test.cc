// Buildings that are written as building files: the same worlds when they are read again.
#include "worldfile/sites/building_text.h"

#include <cstdlib>
#include <filesystem>

#include "tests/support/values.h"
#include "tests/worldfile/world_folder.h"
#include "worldfile/load_world.h"
#include "worldfile/sites/building_yaml.h"

namespace troupe {
namespace {

using test::ValueOf;

void ExpectSame(const WorldDescription& read, const WorldDescription& original) {
  EXPECT_TRUE(read.levels == original.levels);
  EXPECT_TRUE(read.lane_graphs == original.lane_graphs);
  EXPECT_TRUE(read.places == original.places);
  EXPECT_TRUE(read.doors == original.doors);
  EXPECT_TRUE(read.lifts == original.lifts);
  EXPECT_TRUE(read.shapes == original.shapes) << "walls, floors and all others";
  EXPECT_TRUE(read.models == original.models);
  EXPECT_TRUE(read.robots == original.robots);
  EXPECT_TRUE(read.people == original.people && read.goal_sets == original.goal_sets);
  EXPECT_TRUE(read == original);
}

TEST(BuildingText, GivesTheWorldsOfOurBuildings) {
  const std::filesystem::path sites = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites";
  test::TemporaryFolder folder;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sites)) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".building.yaml") && !path.ends_with(".lif.json")) continue;
    SCOPED_TRACE(path);
    const LoadedWorld original = ValueOf(LoadWorld(path));
    const std::string written = folder.Write("copy.building.yaml", BuildingText(*original.site));
    ExpectSame(ValueOf(LoadWorld(written)).world, original.world);
    ++count;
  }
  EXPECT_EQ(count, 9);
}

// Texts that have a meaning in YAML, numbers of many digits, and parts that no building of ours has.
TEST(BuildingText, KeepsOddNamesAndNumbers) {
  const std::string text = R"(
name: "yes: #1"
coordinate_system: cartesian_meters
levels:
  "1.0":
    elevation: 0.1
    vertices:
      - [0.333333, -1e-6, 0, "null", {dock_name: [1, "a \"quoted\" dock"], is_charger: [4, true], human_goal_set_name: [1, "~"]}]
      - [2, 0, 0, "a:b, [c]"]
      - [2, 3, 0, "", {mutex: [1, m], spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, "true"]}]
    models:
      - {model_name: TeleportDispenser, name: "can: 1", x: 1.25, y: 0.5, z: 0.75, yaw: 0}
      - {model_name: TeleportIngestor, name: "bin", x: 1, y: 1.5}
    doors:
      - [0, 1, {name: [1, "no"], type: [1, double_hinged], motion_degrees: [3, 33.3], motion_direction: [2, -1], motion_axis: [1, end], right_left_ratio: [3, 0.7], plugin: [1, none]}]
    lanes:
      - [1, 2, {bidirectional: [4, true], graph_idx: [2, 7], orientation: [1, backward], speed_limit: [3, 0.3], mutex: [1, m]}]
    human_lanes:
      - [0, 2, {graph_idx: [2, 3], width: [3, 1.2]}]
)";
  const Site site = ValueOf(ReadBuildingText(text, "s.building.yaml"));
  const std::string written = BuildingText(site);
  const Site read = ValueOf(ReadBuildingText(written, "s.building.yaml"));
  EXPECT_EQ(read.name, "yes: #1");
  ASSERT_EQ(read.levels.size(), 1u);
  const SiteLevel& level = read.levels[0];
  EXPECT_EQ(level.name, "1.0");
  EXPECT_EQ(level.vertices[0].name, "null");
  EXPECT_EQ(level.vertices[0].position, Vec2(0.333333, -1e-6));
  EXPECT_EQ(level.vertices[0].dock, "a \"quoted\" dock");
  EXPECT_EQ(level.vertices[0].human_goal_set, "~");
  EXPECT_TRUE(level.vertices[0].is_charger);
  EXPECT_EQ(level.vertices[1].name, "a:b, [c]");
  EXPECT_EQ(level.vertices[2].robot_name, "true");
  const SiteDoor& door = level.doors[0];
  EXPECT_EQ(door.name, "no");
  EXPECT_EQ(door.swing, site.levels[0].doors[0].swing);
  EXPECT_TRUE(door.hinge_at_end && !door.opens_clockwise && !door.is_operated);
  EXPECT_EQ(door.right_left_ratio, 0.7);
  EXPECT_EQ(level.lanes[0].graph, 7u);
  EXPECT_EQ(level.lanes[0].orientation, "backward");
  EXPECT_EQ(level.human_lanes[0].width, 1.2);
  EXPECT_EQ(BuildingText(read), written);
}

}  // namespace
}  // namespace troupe
