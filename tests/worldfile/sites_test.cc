// Buildings of Open-RMF: their coordinates, models, places and faults; and a run in one.
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <set>

#include "tests/support/values.h"
#include "tests/worldfile/scenario_run.h"
#include "tests/worldfile/world_folder.h"
#include "worldfile/sites/building_yaml.h"
#include "worldfile/sites/floor_edges.h"
#include "worldfile/sites/site_frame.h"
#include "worldfile/sites/site_tree.h"

namespace troupe {
namespace {

using test::ValueOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string& GuesthousePath() {
  static const std::string path =
      std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites/guesthouse.building.yaml";
  return path;
}

// A building of one level with the given keys.
std::string OneLevel(const std::string& keys, const std::string& top = "") {
  return top + "levels:\n  L1:\n    vertices: [[0, 0, 0, a], [100, 0, 0, b], [100, 40, 0, c], [0, 40, 0, origin]]\n" +
         keys;
}

const std::string kMeasured = "    measurements: [[0, 1, {distance: [3, 10]}]]\n";

Site Read(const std::string& text) {
  return ValueOf(ReadBuildingText(text, "s.building.yaml"));
}

LoadedWorld LoadGuesthouse() {
  return ValueOf(LoadWorld(GuesthousePath()));
}

const ModelDescription& ModelOf(const WorldDescription& world, const std::string& name) {
  for (const ModelDescription& model : world.models) {
    if (model.name == name) return model;
  }
  ADD_FAILURE() << "no model " << name;
  return world.models.front();
}

std::vector<std::string> MessagesOf(const std::vector<Warning>& warnings) {
  std::vector<std::string> messages;
  for (const Warning& warning : warnings) messages.push_back(warning.message);
  return messages;
}

void ExpectNear(const Vec2& found, const Vec2& expected, double tolerance = 1e-9) {
  EXPECT_NEAR(found.x(), expected.x(), tolerance);
  EXPECT_NEAR(found.y(), expected.y(), tolerance);
}

TEST(SiteCoordinates, AnImageHasYDownAndTheMeanScaleOfItsMeasurements) {
  const Site site =
      Read(OneLevel("    measurements: [[0, 1, {distance: [3, 10]}], [1, 2, {distance: [3, 8]}]]\n", "name: hall\n"));
  EXPECT_EQ(site.name, "hall");
  EXPECT_NEAR(site.levels[0].scale, 0.15, 1e-12);  // of 0.1 and 0.2
  ExpectNear(site.levels[0].vertices[2].position, {15.0, -6.0});
  EXPECT_THAT(site.warnings, IsEmpty());
}

TEST(SiteCoordinates, WithoutAMeasurementAPixelIsAMetre) {
  const Site site = Read(OneLevel(""));
  EXPECT_EQ(site.levels[0].scale, 1.0);
  EXPECT_THAT(MessagesOf(site.warnings), ElementsAre(HasSubstr("found no measurement on level 'L1'")));
}

TEST(SiteCoordinates, CartesianMetresHaveYUpAndAnOffset) {
  const Site site =
      Read(OneLevel("", "coordinate_system: cartesian_meters\nparameters: {offset_x: [3, 90], offset_y: [3, 0.5]}\n"));
  ExpectNear(site.levels[0].vertices[2].position, {10.0, 39.5});
}

// The values are of the series of Krueger, by another program.
TEST(SiteCoordinates, ProjectionsAreExactToTheMillimetre) {
  ExpectNear(ProjectionOf("EPSG:3414")->Project(103.77367436885834, 1.2949192688485278),
             {21362.119946756255, 30811.19058072065}, 1e-3);
  ExpectNear(ProjectionOf("EPSG:32631")->Project(2.2945, 48.8582), {448251.7952059537, 5411932.677669734}, 1e-3);
  ExpectNear(ProjectionOf("EPSG:32756")->Project(151.2153, -33.8568), {334900.5696522632, 6252288.752888292}, 1e-3);
  for (const char* other : {"EPSG:3857", "EPSG:32661", "EPSG:3414x", "3414", ""}) EXPECT_FALSE(ProjectionOf(other));
}

TEST(SiteCoordinates, DegreesArePlacedByTheProjectionAndTheSuggestedOffset) {
  const Site site = Read(
      "coordinate_system: wgs84\nparameters: {generate_crs: [1, 'EPSG:3414'], suggested_offset_x: [3, 22000], "
      "suggested_offset_y: [3, 31500]}\nlevels:\n  L1:\n    vertices: [[103.7805632654825, 1.300903083500757, 0, "
      "'']]\n");
  ExpectNear(site.levels[0].vertices[0].position, {128.808052, -27.166755}, 2e-6);
}

TEST(SiteCoordinates, AnUnknownProjectionIsReplacedByMetresAroundTheFirstVertex) {
  const Site site = Read(
      "coordinate_system: wgs84\nparameters: {generate_crs: [1, 'EPSG:2154']}\nlevels:\n  L1:\n    vertices: [[10, 50, "
      "0, ''], [10, 50.001, 0, '']]\n");
  ExpectNear(site.levels[0].vertices[0].position, {0.0, 0.0});
  ExpectNear(site.levels[0].vertices[1].position, {0.0, 111.23}, 0.01);
  EXPECT_THAT(MessagesOf(site.warnings), ElementsAre(HasSubstr("found the coordinate reference system 'EPSG:2154'")));
}

// The same place, once in Web Mercator's square.
TEST(SiteCoordinates, WebMercatorCountsFromItsOriginVertex) {
  const auto pixel = [](double longitude, double latitude) {
    const double phi = latitude * std::numbers::pi / 180.0;
    const double north = std::log(std::tan(0.25 * std::numbers::pi + 0.5 * phi));
    return Vec2(128.0 + longitude / 180.0 * 128.0, 128.0 - north / std::numbers::pi * 128.0);
  };
  const TransverseMercator svy21 = *ProjectionOf("EPSG:3414");
  const Vec2 expected = svy21.Project(103.7810, 1.3012) - svy21.Project(103.7805, 1.3009);
  for (const double sign : {1.0, -1.0}) {
    std::string vertices;
    for (const Vec2& p : {pixel(103.7810, 1.3012), pixel(103.7805, 1.3009)}) {
      char text[80];
      std::snprintf(text, sizeof text, "[%.15g, %.15g, 0, %s],", p.x(), sign * p.y(),
                    vertices.empty() ? "''" : "origin");
      vertices += text;
    }
    const Site site = Read(
        "coordinate_system: web_mercator\nparameters: {generate_crs: [1, 'EPSG:3414']}\nlevels:\n  L1:\n"
        "    vertices: [" +
        vertices + "]\n");
    ExpectNear(site.levels[0].vertices[0].position, expected, 1e-4);
    ExpectNear(site.levels[0].vertices[1].position, {0.0, 0.0});
  }
}

TEST(SiteCoordinates, FiducialsAlignADrawingThatIsTurnedShiftedAndOfAnotherScale) {
  LevelPlan reference;
  LevelPlan level;
  const Vec2 points[] = {{10.0, -20.0}, {50.0, -20.0}, {30.0, -90.0}};
  for (std::size_t i = 0; i < 3; ++i) {
    reference.fiducials.push_back({std::to_string(i), points[i]});
    level.fiducials.push_back({std::to_string(i), {-2.0 * points[i].y() + 7.0, 2.0 * points[i].x() - 3.0}});
  }
  const std::optional<PlaneMap> map = AlignLevel(reference, 0.05, level);
  ASSERT_TRUE(map);
  for (std::size_t i = 0; i < 3; ++i) ExpectNear(*map * level.fiducials[i].position, 0.05 * points[i]);
  level.fiducials.resize(1);
  EXPECT_FALSE(AlignLevel(reference, 0.05, level));
}

TEST(SiteCoordinates, LevelsThatOverlapInHeightAreSetApart) {
  const Site site = Read("levels:\n  top: {elevation: 1, vertices: []}\n  ground: {elevation: 0, vertices: []}\n");
  EXPECT_EQ(site.levels[0].elevation, 2.6);
  EXPECT_EQ(site.levels[1].elevation, 0.0);
  EXPECT_THAT(MessagesOf(site.warnings),
              Contains(HasSubstr("found level 'top' at an elevation of 1 m, expected at least 2.6")));
}

// The end of the only leaf of a door from (10, 0), its start, to (0, 0).
Vec2 OpenEndOf(const std::string& parameters) {
  const Site site = Read(OneLevel("    doors: [[1, 0, {" + parameters + "}]]\n" + kMeasured));
  const WorldDescription world = ValueOf(BuildWorld(ValueOf(SiteTree(std::make_shared<const Site>(site))))).world;
  const DoorLeaf& leaf = world.doors.at(0).leaves.at(0);
  const Rectangle box =
      BoundingBox(world.shape(world.model(world.objects[leaf.object.index()]).shape).blocks[0].outline);
  return Transform2(leaf.X_WH_at(1.0)) * Vec2(box.max_x > -box.min_x ? box.max_x : box.min_x, 0.0);
}

TEST(SiteDoors, OpenToTheSideThatTheFileSays) {
  const std::string hinged = "type: [1, hinged]";
  ExpectNear(OpenEndOf(hinged), {10.0, 10.0}, 0.006);
  ExpectNear(OpenEndOf(hinged + ", motion_direction: [2, -1]"), {10.0, -10.0}, 0.006);
  ExpectNear(OpenEndOf(hinged + ", motion_degrees: [2, -90]"), {10.0, -10.0}, 0.006);
  // As traffic_editor draws it: the leaf turns clockwise about either end.
  ExpectNear(OpenEndOf(hinged + ", motion_axis: [1, end]"), {0.0, -10.0}, 0.006);
  ExpectNear(OpenEndOf(hinged + ", motion_axis: [1, end], motion_direction: [2, -1]"), {0.0, 10.0}, 0.006);
  EXPECT_LT(OpenEndOf("type: [1, sliding], motion_axis: [1, end]").x(), -4.0);
}

TEST(Guesthouse, HasTheLevelsDoorsLanesAndPeopleOfItsFile) {
  const LoadedWorld loaded = LoadGuesthouse();
  ASSERT_NE(loaded.site, nullptr);
  const Site& site = *loaded.site;
  ASSERT_EQ(site.levels.size(), 2u);
  const SiteLevel& ground = site.levels[0];
  EXPECT_EQ(ground.vertices.size(), 32u);
  EXPECT_EQ(ground.walls.size(), 15u);
  EXPECT_EQ(ground.doors.size(), 4u);
  EXPECT_EQ(ground.lanes.size(), 10u);
  EXPECT_EQ(ground.human_lanes.size(), 1u);
  EXPECT_EQ(ground.lanes[2].speed_limit, 0.3);
  EXPECT_EQ(ground.lanes[4].orientation, "forward");
  EXPECT_EQ(ground.lanes[6].graph, 1u);
  EXPECT_FALSE(ground.lanes[8].is_bidirectional);
  EXPECT_EQ(ground.vertices[26].mutex, "lift_lobby");
  EXPECT_EQ(ground.doors[1].name, "lobby_door");
  EXPECT_EQ(ground.doors[1].kind, DoorKind::kDoubleHinged);
  EXPECT_FALSE(ground.doors[2].opens_clockwise);
  EXPECT_EQ(site.levels[1].elevation, 4.0);
  EXPECT_NEAR(site.levels[1].scale, 0.025, 1e-12);  // by its fiducials: it has no measurement
  ExpectNear(site.levels[1].vertices[2].position, ground.vertices[2].position, 1e-6);
  ASSERT_EQ(site.lifts.size(), 1u);
  EXPECT_EQ(site.lifts[0].X_WC, (Pose{10.0, -1.5, 0.0, 0.0}));
  EXPECT_THAT(site.lifts[0].doors_at, ElementsAre(ElementsAre(0u), ElementsAre(0u)));
  EXPECT_TRUE(site.crowd.is_enabled);
  EXPECT_EQ(site.crowd.people(), 3u);
  EXPECT_EQ(site.crowd.profiles[1].speed, 1.2);
  ASSERT_EQ(site.crowd.transitions.size(), 1u);
  EXPECT_EQ(site.crowd.transitions[0].to[0].state, "static");
  EXPECT_EQ(site.crowd.transitions[0].wait, 20.0);
  EXPECT_EQ(site.crowd.transitions[0].distance, 0.5);
}

TEST(Guesthouse, ModelsAreWhereThePlanHasThem) {
  const WorldDescription world = LoadGuesthouse().world;
  EXPECT_EQ(world.name, "guesthouse");
  const ModelDescription& walls = ModelOf(world, "L1.walls");
  const Shape& shape = world.shape(walls.shape);
  ASSERT_EQ(shape.blocks.size(), 15u);
  // The north wall: 12 m, and half its thickness at both ends.
  const Rectangle north = BoundingBox(shape.blocks[0].outline);
  EXPECT_NEAR(north.min_x + walls.X_PM.x, -0.05, 1e-9);
  EXPECT_NEAR(north.max_x + walls.X_PM.x, 12.05, 1e-9);
  EXPECT_NEAR(north.min_y + walls.X_PM.y, -0.05, 1e-9);
  EXPECT_NEAR(north.max_y + walls.X_PM.y, 0.05, 1e-9);
  EXPECT_EQ(shape.blocks[0].z, (ZRange{0.0, 2.5}));
  EXPECT_EQ(ModelOf(world, "L2").X_PM.z, 4.0);
  EXPECT_FALSE(ModelOf(world, "L1.lanes_0").obstacle_return);
  EXPECT_LT(ModelOf(world, "L1.lanes_1").ranger_return, 0.0);
  // Open: along the doorway's x, beside it. The doorway is from (2, -8) to (4, -8).
  EXPECT_NEAR(ModelOf(world, "front_door.right").X_PM.x, 4.5, 1e-9);
  EXPECT_NEAR(ModelOf(world, "front_door.left").X_PM.x, 1.5, 1e-9);
  EXPECT_EQ(ModelOf(world, "room_1_door").X_PM.z, 4.0);
  // The lift is on the ground: its doors are open there, and closed above.
  EXPECT_NEAR(ModelOf(world, "ShaftDoor_guest_lift_L1_lift_door.right").X_PM.x, 10.75, 1e-9);
  EXPECT_NEAR(ModelOf(world, "ShaftDoor_guest_lift_L2_lift_door.right").X_PM.x, 10.25, 1e-9);
  EXPECT_NEAR(ModelOf(world, "CabinDoor_guest_lift_lift_door.right").X_PM.x, 10.75, 1e-9);
  EXPECT_EQ(world.shape(ModelOf(world, "guest_lift.cabin").shape).blocks.size(),
            6u);  // floor, 3 sides, 2 beside the door
  const RobotDescription& tiny = world.robot(*FindRobot(world, "tiny_1"));
  ExpectNear(world.model(tiny.root).X_PM.translation(), {1.5, -2.0});
  EXPECT_NEAR(world.model(tiny.root).X_PM.heading, std::atan2(-1.75, 1.5), 1e-12);  // along its lane
  EXPECT_EQ(tiny.drive.velocity.x.max, 0.5);
  // Backward: away from its lane.
  const RobotDescription& delivery = world.robot(*FindRobot(world, "delivery_1"));
  EXPECT_NEAR(world.model(delivery.root).X_PM.heading, std::atan2(2.25, 1.5), 1e-12);
}

TEST(Guesthouse, VerticesWithANameOrARoleArePlaces) {
  const WorldDescription world = LoadGuesthouse().world;
  std::map<std::string, NamedPlace> places;
  for (const NamedPlace& place : world.places) places.emplace(place.name, place);
  EXPECT_EQ(places.size(), 12u);
  EXPECT_THAT(places["charger_1"].tags,
              ElementsAre("L1", "charger", "parking_spot", "robot:tiny_1", "fleet:TinyRobot"));
  EXPECT_THAT(places["pantry"].tags, ElementsAre("L1", "dock:pantry_dock", "dispenser:pantry_dispenser"));
  EXPECT_THAT(places["L1.31"].tags, ElementsAre("L1", "people:seats"));
  EXPECT_EQ(places["room_1"].X_WN, (Pose{3.0, -5.5, 4.0, 0.0}));
}

TEST(Guesthouse, AScenarioAddsRobotsOnAnyLevelAndReplacesPlaces) {
  test::TemporaryFolder folder;
  std::filesystem::copy(GuesthousePath(), folder.Path("g.building.yaml"));
  const auto load = [&](const std::string& z) {
    return ValueOf(LoadWorld(folder.Write(
        "s.json",
        R"({"world": "g.building.yaml", "robots": [{"name": "above", "model": "TinyRobot", "pose": [1.5, -2, )" + z +
            R"(, 0]}], "places": [{"name": "lobby", "pose": [3, -4, 0]}]})")));
  };
  const LoadedWorld loaded = load("4");
  EXPECT_EQ(loaded.world.robots.size(), 3u);
  EXPECT_EQ(loaded.world.places.size(), 12u);
  EXPECT_EQ(loaded.world.places.back().name, "lobby");
  EXPECT_EQ(loaded.world.places.back().X_WN.y, -4.0);
  EXPECT_THAT(MessagesOf(loaded.warnings), Not(Contains(HasSubstr("above"))));
  EXPECT_THAT(MessagesOf(load("0").warnings), Contains(HasSubstr("above")));  // inside tiny_1
}

TEST(Guesthouse, AScenarioOverridesPropertiesOfDoorsAndLifts) {
  test::TemporaryFolder folder;
  std::filesystem::copy(GuesthousePath(), folder.Path("g.building.yaml"));
  const WorldDescription before = LoadGuesthouse().world;
  const WorldDescription world = ValueOf(LoadWorld(folder.Write("s.json", R"({"world": "g.building.yaml", "override": [
    {"match": {"name": "lobby_door"}, "properties": {"kind": "sliding", "opening": 0.25, "seconds": 7}},
    {"match": {"name": "guest_lift"}, "properties": {"speed": 0.5}}]})")))
                                     .world;
  const DoorDescription& door = world.doors[*FindDoor(world, "lobby_door")];
  EXPECT_EQ(before.doors[*FindDoor(before, "lobby_door")].leaves.size(), 2u);
  ASSERT_EQ(door.leaves.size(), 1u);
  EXPECT_EQ(door.leaves[0].turn, 0.0);
  EXPECT_EQ(door.opening, 0.25);
  EXPECT_EQ(door.seconds, 7.0);
  EXPECT_EQ(world.lifts[0].speed, 0.5);
  EXPECT_EQ(world.lifts[0].floors.size(), before.lifts[0].floors.size());
  EXPECT_EQ(world.lifts[0].floors[0].doors, before.lifts[0].floors[0].doors);
}

TEST(Guesthouse, ARobotDrivesThroughAnOpenDoorAndStopsAtAWall) {
  test::TemporaryFolder folder;
  std::filesystem::copy(GuesthousePath(), folder.Path("g.building.yaml"));
  const std::string scenario = R"({"world": "g.building.yaml", "robots": [
    {"name": "tiny_1", "pose": [4.5, -3.75, 0],
     "controller": {"name": "go_to", "parameters": {"waypoints": [[7, -3.75]]}}},
    {"name": "delivery_1", "pose": [4.5, -1.2, 0],
     "controller": {"name": "go_to", "parameters": {"waypoints": [[7, -1.2]]}}}]})";
  ScenarioRun run(ValueOf(LoadWorld(folder.Write("s.json", scenario))).world);
  run.Run(150);
  EXPECT_NEAR(run["tiny_1"].X_WR.x, 7.0, 0.3);
  EXPECT_TRUE(run.EverStalled("delivery_1"));
  EXPECT_LE(run["delivery_1"].X_WR.x, 6.0 - 0.05 - 0.35 + 1e-6);
  EXPECT_FALSE(run.InsideSomething("tiny_1"));
}

TEST(SiteTree, AnUnknownRobotModelIsABoxAndUnknownKeysAreNamedOnce) {
  const std::string robots =
      "    vertices: [[0, 0, 0, a, {spawn_robot_type: [1, Acme/Mover], spawn_robot_name: [1, m1]}], [90, 0, 0, b, "
      "{spawn_robot_type: [1, Acme/Mover], spawn_robot_name: [1, m2], is_shiny: [4, true]}]]\n";
  Site site =
      Read("levels:\n  L1:\n" + robots + kMeasured + "    models: [{model_name: Chair}, {model_name: Chair}]\n");
  const WorldTree tree = ValueOf(SiteTree(std::make_shared<const Site>(std::move(site))));
  EXPECT_THAT(
      MessagesOf(tree.warnings),
      ElementsAre("key 'is_shiny' of a vertex has no effect",
                  "found 2 models of 1 kind, whose shapes are not in this file; they are left out",
                  "found the robot model 'Acme/Mover', which is not known; a box of 0.6 m, 'SiteRobot', is used"));
  EXPECT_EQ(ValueOf(BuildWorld(tree)).world.robots.size(), 2u);
}

// Those of Open-RMF's demo sites: a vertex beside them has the same name as a tag.
TEST(SiteTree, TeleportingModelsArePlacesOfDispensersAndIngestors) {
  Site site = Read(
      "levels:\n  L1:\n    elevation: 1\n    vertices: [[0, 0, 0, pantry, {pickup_dispenser: [1, "
      "coke_dispenser]}], [90, 0, 0, b]]\n" +
      std::string(kMeasured) +
      "    models: [{model_name: OpenRobotics/TeleportDispenser, name: coke_dispenser, x: 90, y: 90, yaw: 1.5, z: "
      "0.5}, "
      "{model_name: TeleportIngestor, name: b, x: 0, y: 90}]\n");
  EXPECT_EQ(site.furniture, 0u);
  const double metres = site.levels[0].vertices[1].position.x();
  const WorldDescription world = ValueOf(BuildWorld(ValueOf(SiteTree(std::make_shared<const Site>(site))))).world;
  ASSERT_EQ(world.places.size(), 4u);
  EXPECT_EQ(world.places[2].name, "coke_dispenser");
  EXPECT_THAT(world.places[2].tags, ElementsAre("L1", "dispenser:coke_dispenser"));
  EXPECT_NEAR(world.places[2].X_WN.x, metres, 1e-6);
  EXPECT_NEAR(world.places[2].X_WN.y, -metres, 1e-6);
  EXPECT_NEAR(world.places[2].X_WN.z, 1.5, 1e-9);
  EXPECT_NE(world.places[3].name, "b") << "a vertex has this name";
  EXPECT_THAT(world.places[3].tags, ElementsAre("L1", "ingestor:b"));
}

// A closed room of 3 m, and a state whose goals are in it; `group`: of the crowd; `area`: of its goal set.
std::string CrowdOf(const std::string& group, const std::string& area = "seats") {
  return R"(name: crowd
coordinate_system: cartesian_meters
levels:
  G:
    vertices: [[0, 0], [3, 0], [3, 3], [0, 3], [2, 2, 0, seat, {human_goal_set_name: [1, seats]}], [-5, -5], [8, -5], [8, 8], [-5, 8]]
    walls: [[0, 1], [1, 2], [2, 3], [3, 0]]
    floors: [{vertices: [5, 6, 7, 8]}]
crowd_sim:
  enable: 1
  agent_profiles: [{name: human, max_speed: 1.5, pref_speed: 1.2, r: 0.25}]
  agent_groups: [{profile_selector: human, state_selector: go, )" +
         group + R"(}]
  states: [{name: go, goal_set: 0}]
  goal_sets: [{set_id: 0, set_area: [)" +
         area + R"(]}]
)";
}

TEST(Crowd, StartsWhereItCanWalkToThePointOfItsGroup) {
  test::TemporaryFolder folder;
  const auto load = [&](const std::string& text) { return ValueOf(LoadWorld(folder.Write("c.building.yaml", text))); };
  for (const auto& [at, is_inside] : {std::pair("x: 1, y: 1", true), std::pair("x: -1, y: 1", false)}) {
    const LoadedWorld loaded = load(CrowdOf("agents_number: 4, " + std::string(at)));
    EXPECT_THAT(MessagesOf(loaded.warnings), IsEmpty());
    ASSERT_EQ(loaded.world.people.size(), 4u);
    for (const PersonDescription& person : loaded.world.people) {
      const Pose& start = loaded.world.model(person.root).X_PM;
      EXPECT_EQ(start.x > 0.0 && start.x < 3.0 && start.y > 0.0 && start.y < 3.0, is_inside)
          << start.x << " " << start.y;
    }
  }
  EXPECT_THAT(LoadWorld(folder.Write("c.building.yaml", CrowdOf("agents_number: 90, x: 1, y: 1"))).error().ToString(),
              AllOf(HasSubstr("c.building.yaml:11:18: error: found room for"), HasSubstr("of 90 people")));
  EXPECT_THAT(MessagesOf(load(CrowdOf("agents_number: 1, x: 20, y: 1")).warnings),
              ElementsAre("found a group of people at (20, 1), outside of the floors of level 'G', expected a point on "
                          "one of them"));
  EXPECT_THAT(MessagesOf(load(CrowdOf("agents_number: 1, x: 1, y: 1", "tables")).warnings),
              ElementsAre(HasSubstr("found a goal set without vertices")));
}

// An upper floor of two parts that touch, with a wall along its north side and a lift at its west side.
constexpr const char* kVoid = R"(name: void
coordinate_system: cartesian_meters
levels:
  L1: {vertices: [[0, 0], [20, 0], [20, 20], [0, 20]], floors: [{vertices: [0, 1, 2, 3]}]}
  L2:
    elevation: 4
    vertices: [[0, 0], [5, 0], [5, 5], [0, 5], [10, 0], [10, 3], [5, 3]]
    floors: [{vertices: [0, 1, 2, 3]}, {vertices: [1, 4, 5, 6]}]
    walls: [[3, 2]]
lifts:
  up:
    {width: 2, depth: 2, x: -1.1, y: 2.5, yaw: 0, initial_floor_name: L1,
     doors: {d: {motion_axis_orientation: 1.5708, width: 1.2, x: 1, y: 0}}, level_doors: {L1: [d], L2: [d]}}
)";

TEST(FloorEdges, AreThoseOverAVoidWithoutAWall) {
  const Site site = Read(kVoid);
  EXPECT_TRUE(FindFloorEdges(site, site.levels[0]).empty()) << "the ground";
  double length = 0.0;
  for (const FloorEdge& edge : FindFloorEdges(site, site.levels[1])) {
    length += (edge.to - edge.from).norm();
    EXPECT_FALSE(edge.from.x() == 5.0 && edge.to.x() == 5.0 && edge.from.y() < 2.9) << "between the floors";
    EXPECT_LT(edge.from.y(), 5.0) << "at the wall";
  }
  // South 10, east 3, north of the second part 5, its joint with the first 2, west 5 without the lift.
  EXPECT_NEAR(length, 10.0 + 3.0 + 5.0 + 2.0 + 5.0 - 2.6, 0.5);
  const Site guesthouse = *LoadGuesthouse().site;
  for (const SiteLevel& level : guesthouse.levels) EXPECT_TRUE(FindFloorEdges(guesthouse, level).empty());
}

TEST(FloorEdges, StopRobotsAndPeople) {
  test::TemporaryFolder folder;
  folder.Write("v.building.yaml", kVoid);
  const LoadedWorld loaded = ValueOf(LoadWorld(folder.Write("s.json", R"({"world": "v.building.yaml",
    "people": [{"count": 1, "region": [8.9, 1.4, 9.1, 1.6], "z": 4, "goals": [[1, 4, 4]], "name_prefix": "p"}],
    "robots": [{"name": "r", "model": "TinyRobot", "pose": [7, 1, 4, -90], "controller": {"name": "script",
      "parameters": {"commands": [{"at": 0, "vx": 0.5}]}}}]})")));
  EXPECT_THAT(MessagesOf(loaded.warnings),
              Contains(HasSubstr("m of edges of the floors of level 'L2' without a wall")));
  ScenarioRun run(loaded.world);
  for (int i = 0; i < 300; ++i) {
    run.Run(1);
    const Pose& person = run.state().people[0].X_WP;
    EXPECT_TRUE(person.x < 5.1 || person.y < 3.0) << "it walks round the corner";
  }
  EXPECT_TRUE(run["r"].stalled);
  EXPECT_GT(run["r"].X_WR.y, 0.0);
  EXPECT_LT((run.state().people[0].X_WP.translation() - Vec2(1.0, 4.0)).norm(), 0.6);
}

struct BadBuilding {
  std::string text;
  std::string where;
  std::string what;
};

TEST(BadBuilding, GivesOneLineWithThePlaceAndTheExpectedText) {
  const BadBuilding cases[] = {
      {"- 1\n", "1:1", "found no YAML map, expected keys such as 'levels'"},
      {"name: [\n", "2:1", "found text that is not YAML (end of sequence flow not found), expected YAML"},
      {"name: a\n", "1:1", "found no key 'levels' in the building, expected it"},
      {"levels: {}\n", "1:9", "found no level, expected at least one"},
      {"levels: 5\n", "1:9", "found '5' for 'levels', expected a map"},
      {"levels:\n  L1: {elevation: high}\n", "2:19", "found 'high' for the elevation of level 'L1', expected a number"},
      {"levels:\n  L1: {vertices: 7}\n", "2:18", "found '7' for the vertices of level 'L1', expected a list"},
      {"levels:\n  L1: {vertices: [[1]]}\n", "2:19", "found 1 value for a vertex, expected a list of at least 2"},
      {"levels:\n  L1: {vertices: [[1, x]]}\n", "2:23", "found 'x' for the y of a vertex, expected a number"},
      {OneLevel("    walls: [[0, 9]]\n"), "4:17",
       "found '9' for the second vertex of one of the walls of level 'L1', expected a number from 0 to 3"},
      {OneLevel("    doors: [[0, 1, {type: [1, magic]}]]\n"), "4:31",
       "found the door type 'magic', expected hinged, double_hinged, sliding or double_sliding"},
      {OneLevel("    measurements: [[0, 0, {distance: [3, 1]}]]\n"), "4:20",
       "found a measurement of 1 m between points at a distance of 0, expected both above 0"},
      {OneLevel("", "coordinate_system: polar\n"), "1:20",
       "found the coordinate system 'polar', expected reference_image, cartesian_meters, web_mercator or wgs84"},
      {OneLevel("", "reference_level_name: L2\n"), "1:23", "found no level 'L2', expected the name of one"},
      {OneLevel("lifts:\n  up: {width: 1, depth: 1, x: 0, y: 0}\n"), "5:7",
       "found no key 'yaw' in lift 'up', expected it"},
      {OneLevel("lifts:\n  up: {width: 1, depth: 1, x: 0, y: 0, yaw: 0, level_doors: {L1: [front]}}\n"), "5:67",
       "found no door of this name in lift 'up', expected one of its doors"},
      {OneLevel("crowd_sim: {agent_groups: [{agents_number: 1, profile_selector: human}]}\n"), "4:65",
       "found no profile 'human' in 'crowd_sim', expected one"},
      {OneLevel("crowd_sim: {agent_profiles: [{name: p, r: 0.01}]}\n"), "4:43",
       "found 0.01 for 'r', expected 0, for the usual radius, or 0.05 to 10"},
      {OneLevel("crowd_sim: {states: [{name: s}], transitions: [{from: s, Target: [{name: t}]}]}\n"), "4:74",
       "found no state 't' in 'crowd_sim', expected one"},
      {"levels:\n  L1: {vertices: [[0, 0], [0, 0, 0, in, {lift_cabin: [1, up]}]]}\n", "2:27",
       "found a vertex in the cabin of lift 'up', expected the name of a lift"},
  };
  for (const BadBuilding& bad : cases) {
    const Result<Site> read = ReadBuildingText(bad.text, "s.building.yaml");
    ASSERT_FALSE(read.ok()) << bad.text;
    EXPECT_EQ(read.error().ToString(), "s.building.yaml:" + bad.where + ": error: " + bad.what) << bad.text;
  }
}

// A text of some kilobytes, whose aliases stand for very many walls.
TEST(BadBuilding, HasNoMorePartsThanAMachineHasRoomFor) {
  std::string walls = "    walls:\n      - &w [0, 1]\n";
  for (int i = 0; i < 100'000; ++i) walls += "      - *w\n";
  const Result<Site> read = ReadBuildingText(OneLevel(walls), "s.building.yaml");
  ASSERT_FALSE(read.ok());
  EXPECT_THAT(read.error().ToString(), HasSubstr("s.building.yaml:5:7: error: found more than 100000 vertices, edges"));
}

}  // namespace
}  // namespace troupe
