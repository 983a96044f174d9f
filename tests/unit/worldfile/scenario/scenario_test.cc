#include "worldfile/scenario/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/base/glob.h"
#include "common/model/states.h"
#include "common/spatial/convex_piece.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

std::string WorldsFolder() {
  return std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds";
}

Result<LoadedWorld> Load(const std::string& text, const LoadOverrides& overrides = {}) {
  return LoadScenarioText(text, WorldsFolder() + "/scenarios/test.json", overrides);
}

// Loads a scenario that must be valid.
LoadedWorld MustLoad(const std::string& text, const LoadOverrides& overrides = {}) {
  Result<LoadedWorld> loaded = Load(text, overrides);
  EXPECT_TRUE(loaded.ok()) << loaded.error().ToString();
  return loaded.ok() ? std::move(loaded).value() : LoadedWorld{};
}

const ModelDescription& Model(const LoadedWorld& loaded, const std::string& name) {
  for (const ModelDescription& model : loaded.world.models) {
    if (model.name == name) return model;
  }
  ADD_FAILURE() << "no model " << name;
  return loaded.world.models.front();
}

const RobotDescription& Robot(const LoadedWorld& loaded, const std::string& name) {
  for (const RobotDescription& robot : loaded.world.robots) {
    if (robot.name == name) return robot;
  }
  ADD_FAILURE() << "no robot " << name;
  return loaded.world.robots.front();
}

TEST(Scenario, GivesTheSettingsOfARun) {
  const LoadedWorld loaded = MustLoad(R"({
    "name": "quiet", "seed": 9223372036854775807, "ticks": 12, "mode": "realtime", "speed": 2.5,
    "on_agent_loss": "abort", "robots_per_process": 4, "restart_agents": 9, "agent_deadline": 1.5, "properties": {"interval_sim": 50}})");
  EXPECT_EQ(loaded.world.name, "quiet");
  EXPECT_EQ(loaded.world.seed, 9223372036854775807u);
  EXPECT_EQ(loaded.world.interval_ns, 50'000'000);
  EXPECT_EQ(loaded.settings.ticks, 12u);
  EXPECT_EQ(loaded.settings.mode, Mode::kRealtime);
  EXPECT_EQ(loaded.settings.speed, 2.5);
  EXPECT_EQ(loaded.settings.on_agent_loss, OnAgentLoss::kAbort);
  EXPECT_EQ(loaded.settings.robots_per_process, 4u);
  EXPECT_EQ(loaded.settings.restart_agents, 9u);
  EXPECT_EQ(loaded.settings.agent_deadline_seconds, 1.5);
}

TEST(Scenario, LeavesTheDefaultsOfARun) {
  const LoadedWorld loaded = MustLoad("{}");
  EXPECT_EQ(loaded.settings.ticks, std::nullopt);
  EXPECT_EQ(loaded.settings.mode, Mode::kLockstep);
  EXPECT_EQ(loaded.settings.speed, std::nullopt);
  EXPECT_EQ(loaded.settings.on_agent_loss, OnAgentLoss::kFreeze);
  EXPECT_EQ(loaded.settings.restart_agents, kDefaultRestartAgents);
  EXPECT_TRUE(loaded.world.models.empty());
  EXPECT_THAT(loaded.files, testing::ElementsAre(testing::EndsWith("test.json")));
  EXPECT_EQ(MustLoad(R"({"speed": "max"})").settings.speed, std::nullopt);
}

TEST(Scenario, AddsRobotsWithPosesInMetresAndDegrees) {
  const LoadedWorld loaded = MustLoad(R"({
    "include": ["../include/robots.inc"],
    "robots": [
      {"name": "a", "model": "scout", "pose": [1, 2, 90]},
      {"name": "b", "model": "porter", "pose": [3, 4, 0.5, -90], "properties": {"color": "blue"}},
      {"model": "scout", "pose": [7, 0, 0]}
    ]})");
  ASSERT_EQ(loaded.world.robots.size(), 3u);
  EXPECT_EQ(Model(loaded, "a").X_PM, (Pose{1, 2, 0, 0.5 * kPi}));
  EXPECT_EQ(Model(loaded, "b").X_PM, (Pose{3, 4, 0.5, -0.5 * kPi}));
  EXPECT_EQ(Model(loaded, "b").color, (Color{0, 0, 1, 1}));
  EXPECT_EQ(Model(loaded, "scout0").X_PM.x, 7);
  EXPECT_EQ(Robot(loaded, "a").sensors.size(), 2u);
}

TEST(Scenario, ConvertsPosesToTheUnitsOfTheWorld) {
  const LoadedWorld loaded = MustLoad(R"({
    "properties": {"unit_length": "cm", "unit_angle": "radians"},
    "models": [{"name": "a", "model": "model", "pose": [1.5, -2, 0.25, 90], "properties": {"size": [50, 20, 100]}}]})");
  const Pose& pose = Model(loaded, "a").X_PM;
  EXPECT_NEAR(pose.x, 1.5, 1e-12);
  EXPECT_NEAR(pose.y, -2.0, 1e-12);
  EXPECT_NEAR(pose.z, 0.25, 1e-12);
  EXPECT_NEAR(pose.heading, 0.5 * kPi, 1e-12);
  EXPECT_NEAR(Model(loaded, "a").size_x, 0.5, 1e-12);
}

TEST(Scenario, AWorldCanBeWrittenWhollyInJson) {
  const LoadedWorld loaded = MustLoad(R"({
    "models": [{
      "name": "desk", "model": "model", "pose": [1, 0, 0], "properties": {"size": [2, 1, 0.75], "obstacle_return": false},
      "children": [{"name": "lamp", "model": "model", "properties": {"size": [0.1, 0.1, 0.4], "color": "yellow"}}]
    }],
    "robots": [{
      "name": "r", "model": "position", "properties": {"drive": "omni"},
      "children": [{"model": "ranger", "children": [
        {"model": "sensor", "properties": {"range": [0.1, 6], "fov": 180, "samples": 91}}]}]
    }]})");
  EXPECT_FALSE(Model(loaded, "desk").obstacle_return);
  EXPECT_NEAR(Model(loaded, "desk.lamp").X_PM.z, 0.75, 1e-12);
  const RobotDescription& robot = Robot(loaded, "r");
  EXPECT_EQ(robot.drive.type, DriveType::kOmni);
  ASSERT_EQ(robot.sensors.size(), 1u);
  ASSERT_EQ(RaySensors(robot.sensors[0]).size(), 1u);
  EXPECT_EQ(RaySensors(robot.sensors[0])[0].samples, 91u);
  EXPECT_EQ(RaySensors(robot.sensors[0])[0].range, (Interval{0.1, 6}));
}

TEST(Scenario, ChangesARobotThatTheWorldHas) {
  const LoadedWorld loaded = MustLoad(R"({
    "models": [{"name": "r", "model": "position", "pose": [1, 2, 0.5, 0], "properties": {"ctrl": "wander"}}],
    "robots": [{"name": "r", "pose": [5, 6, 180], "controller": {"name": "script", "parameters": {"a": [1, {"b": 2}]}}}]
  })");
  EXPECT_EQ(Model(loaded, "r").X_PM, (Pose{5, 6, 0.5, kPi}));
  EXPECT_EQ(Robot(loaded, "r").controller.name, "script");
  EXPECT_EQ(Robot(loaded, "r").controller.parameters, R"({"a":[1,{"b":2}]})");
}

TEST(Scenario, TheDefaultControllerIsForRobotsWithoutOne) {
  const std::string text = R"({
    "controller": {"name": "expand", "parameters": {"speed": 1}},
    "robots": [
      {"name": "none", "model": "position"},
      {"name": "own", "model": "position", "pose": [2, 0, 0], "controller": "idle"},
      {"name": "ctrl", "model": "position", "pose": [4, 0, 0], "properties": {"ctrl": "wander"}}
    ]})";
  const LoadedWorld loaded = MustLoad(text);
  EXPECT_EQ(Robot(loaded, "none").controller.name, "expand");
  EXPECT_EQ(Robot(loaded, "none").controller.parameters, R"({"speed":1})");
  EXPECT_EQ(Robot(loaded, "own").controller.name, "idle");
  EXPECT_EQ(Robot(loaded, "ctrl").controller.name, "wander");

  LoadOverrides overrides;
  overrides.controller = "script";
  const LoadedWorld overridden = MustLoad(text, overrides);
  EXPECT_EQ(Robot(overridden, "none").controller.name, "script");
  EXPECT_EQ(Robot(overridden, "own").controller.name, "idle");
}

TEST(Scenario, LibrariesOfControllersStartAtItsFolder) {
  const LoadedWorld loaded = MustLoad(R"({"robots": [
    {"name": "a", "model": "position", "controller": "../lib/own.so"},
    {"name": "b", "model": "position", "pose": [3, 0, 0], "controller": "/lib/own.so"}]})");
  EXPECT_EQ(Robot(loaded, "a").controller.name, WorldsFolder() + "/lib/own.so");
  EXPECT_EQ(Robot(loaded, "b").controller.name, "/lib/own.so");
}

TEST(Scenario, OverridesChangeModelsByNameAndType) {
  const LoadedWorld loaded = MustLoad(R"({
    "world": "../office.world",
    "robots": [{"name": "a", "model": "scout", "pose": [0, 0, 0]}],
    "override": [
      {"match": {"type": "chair"}, "properties": {"obstacle_return": 0, "ranger_return": -1}},
      {"match": {"name": "table?"}, "properties": {"color": "blue"}},
      {"match": {"name": "table0"}, "properties": {"size": [3.2, 0.8, 0.72]}},
      {"match": {"type": "sensor"}, "properties": {"samples": 5}}
    ]})");
  EXPECT_FALSE(Model(loaded, "chair3").obstacle_return);
  EXPECT_EQ(Model(loaded, "chair3").ranger_return, -1.0);
  EXPECT_TRUE(Model(loaded, "table3").obstacle_return);
  EXPECT_EQ(Model(loaded, "table0").size_x, 3.2);
  EXPECT_EQ(Model(loaded, "table1").size_x, 1.6);
  for (const SensorDescription& ranger : Robot(loaded, "a").sensors) {
    for (const RaySensorDescription& sensor : RaySensors(ranger)) EXPECT_EQ(sensor.samples, 5u);
  }
}

// Robots of one macro share its nodes until one is changed.
TEST(Scenario, AnOverrideBelowOneRobotLeavesTheOthersAlone) {
  const LoadedWorld loaded = MustLoad(R"({
    "include": ["../include/robots.inc"],
    "robots": [{"name": "a", "model": "scout", "pose": [0, 0, 0]}, {"name": "b", "model": "scout", "pose": [3, 0, 0]},
               {"name": "c", "model": "scout", "pose": [6, 0, 0]}],
    "override": [{"match": {"name": "b.ranger:0"}, "properties": {"color": "blue"}},
                 {"match": {"name": "c"}, "properties": {"color": "green"}}]})");
  const auto color = [&](const std::string& name) { return Model(loaded, name).color; };
  EXPECT_NE(color("b.ranger:0"), color("a.ranger:0"));
  EXPECT_EQ(color("c.ranger:0"), color("a.ranger:0"));
  EXPECT_EQ(color("b"), color("a"));
  EXPECT_NE(color("c"), color("a"));
}

TEST(Scenario, ItsWorldMayBeARosMap) {
  const std::string path = testing::TempDir() + "scenario_test_map.yaml";
  std::ofstream(path) << "image: " << WorldsFolder() << "/bitmaps/office.png\nresolution: 0.05\norigin: [-12, -8, 0]\n"
                      << "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  const LoadedWorld loaded = MustLoad(R"({"world": ")" + path + R"(", "include": ["../include/robots.inc"],
    "spawn": [{"model": "scout", "count": 20, "region": [-11, -7, 11, 7]}]})");
  EXPECT_EQ(loaded.map_width, 480);
  EXPECT_EQ(loaded.world.robots.size(), 20u);
}

TEST(Scenario, ABitmapOfAScenarioWithARelativePathIsFound) {
  const std::string path = std::filesystem::relative(WorldsFolder()).string() + "/scenarios/test.json";
  const Result<LoadedWorld> loaded = LoadScenarioText(R"({"models": [{"name": "m", "model": "model",
      "properties": {"bitmap": "../bitmaps/office.png", "size": [10, 10, 1]}}]})",
                                                      path);
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  EXPECT_EQ(loaded.value().map_width, 480);
}

TEST(Scenario, WarningsHaveTheirPlace) {
  const LoadedWorld loaded = MustLoad(
      "{\"models\": [\n"
      "  {\"model\": \"model\", \"properties\": {\n"
      "    \"colour\": \"red\"}}]}");
  std::vector<std::string> warnings;
  for (const Warning& warning : loaded.warnings) warnings.push_back(warning.ToString());
  EXPECT_THAT(warnings,
              testing::Contains(testing::AllOf(testing::HasSubstr("test.json:3:"), testing::HasSubstr("colour"))));
}

TEST(Scenario, NamesTheHostsThatItRunsOn) {
  const std::string path = testing::TempDir() + "scenario_test_hosts.json";
  std::ofstream(path) << R"({"network": "unicast", "hosts": ["alpha",
    {"address": "10.0.0.2", "name": "beta", "start": "on beta {command}", "programs": "/opt/bin", "interface": "eth1",
     "service": true, "robots": ["r*", "x"]},
    {"address": "10.0.0.3", "robots": 7}]})";
  const HostsOfScenario read = test::ValueOf(ReadHostsOfScenario(path));
  EXPECT_EQ(read.network, "unicast");
  const std::vector<HostSettings>& hosts = read.hosts;
  ASSERT_EQ(hosts.size(), 3u);
  EXPECT_EQ(hosts[0].name, "alpha");
  EXPECT_EQ(hosts[0].address, "alpha");
  EXPECT_FALSE(hosts[0].robot_count);
  EXPECT_EQ(hosts[1].name, "beta");
  EXPECT_EQ(hosts[1].start, "on beta {command}");
  EXPECT_EQ(hosts[1].programs, "/opt/bin");
  EXPECT_EQ(hosts[1].network_interface, "eth1");
  EXPECT_TRUE(hosts[1].service);
  EXPECT_THAT(hosts[1].robot_names, testing::ElementsAre("r*", "x"));
  EXPECT_EQ(hosts[1].where.line, 2);
  EXPECT_EQ(hosts[2].name, "10.0.0.3");
  EXPECT_EQ(hosts[2].robot_count, 7u);
}

TEST(Scenario, GlobsMatchAsInAShell) {
  EXPECT_TRUE(MatchesGlob("*", ""));
  EXPECT_TRUE(MatchesGlob("r*", "r12"));
  EXPECT_TRUE(MatchesGlob("*.ranger:?", "r0.ranger:1"));
  EXPECT_TRUE(MatchesGlob("a*b*c", "aXbYbZc"));
  EXPECT_FALSE(MatchesGlob("a*b*c", "aXbYbZ"));
  EXPECT_FALSE(MatchesGlob("r?", "r"));
  EXPECT_FALSE(MatchesGlob("", "r"));
}

TEST(Scenario, ControllersAreCheckedWithoutTheWorld) {
  const std::string path = testing::TempDir() + "scenario_test_check.json";
  std::ofstream(path) << R"({"world": "not/there.world", "controller": "wonder"})";
  LoadOverrides overrides;
  EXPECT_TRUE(CheckScenario(path, overrides).ok());
  overrides.check_controller = [](const std::string& name, const std::string&) -> Status {
    return Error{{}, "unknown " + name};
  };
  const Status error = CheckScenario(path, overrides);
  ASSERT_FALSE(error.ok());
  EXPECT_EQ(error.error().ToString(), path + ":1:44: error: unknown wonder");
}

// Spawn rules.

std::string SpawnText(const std::string& seed) {
  return R"({"world": "../office.world", "seed": )" + seed + R"(, "spawn": [
    {"model": "scout", "count": 60, "region": [-12, -8, 12, 8], "spacing": 0.9, "name_prefix": "s"},
    {"model": "carton", "count": 15, "region": [[0.5, 1.5], [11.5, 1.5], [11.5, 7.5]], "heading": 45, "name_prefix": "box"},
    {"model": "porter", "count": 10, "region": [-11, -1, 11, 1], "heading": 90, "controller": "wander"}
  ]})";
}

// All pieces of the model's tree in the world.
std::vector<ConvexPiece> PiecesOf(const WorldDescription& world, ModelId root) {
  const std::vector<Pose> poses = ModelPoses(world, PlacedState(world));
  std::vector<ConvexPiece> pieces;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    ModelId top(i);
    while (world.model(top).parent) top = *world.model(top).parent;
    if (top != root) continue;
    for (ConvexPiece& piece : MakePieces(world, ModelId(i), poses[i])) pieces.push_back(std::move(piece));
  }
  return pieces;
}

bool Overlap(const std::vector<ConvexPiece>& a, const std::vector<ConvexPiece>& b) {
  for (const ConvexPiece& p : a) {
    for (const ConvexPiece& q : b) {
      if (p.z.Overlaps(q.z) && PenetrationDepth(p.vertices, q.vertices) > kTouchTolerance) return true;
    }
  }
  return false;
}

class SpawnTest : public testing::TestWithParam<int> {};

TEST_P(SpawnTest, NoModelsOverlapAndSpacingAndRegionsAreKept) {
  const LoadedWorld loaded = MustLoad(SpawnText(std::to_string(GetParam())));
  const WorldDescription& world = loaded.world;
  std::vector<ModelId> spawned, standing;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.parent) continue;
    const bool is_spawned = (model.name[0] == 's' && std::isdigit(model.name[1])) || model.name.starts_with("porter") ||
                            model.name.starts_with("box");
    (is_spawned ? spawned : standing).push_back(ModelId(i));
  }
  std::vector<std::vector<ConvexPiece>> bodies, others;
  for (const ModelId id : spawned) bodies.push_back(PiecesOf(world, id));
  for (const ModelId id : standing) others.push_back(PiecesOf(world, id));
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const ModelDescription& model = world.model(spawned[i]);
    for (const auto& other : others) EXPECT_FALSE(Overlap(bodies[i], other)) << model.name;
    for (std::size_t j = 0; j < i; ++j) {
      const ModelDescription& other = world.model(spawned[j]);
      EXPECT_FALSE(Overlap(bodies[i], bodies[j])) << model.name << " and " << other.name;
      if (model.name[0] == 's' && other.name[0] == 's') {
        EXPECT_GE((model.X_PM.translation() - other.X_PM.translation()).norm(), 0.9);
      }
    }
    if (model.name.starts_with("porter")) {
      EXPECT_EQ(model.X_PM.heading, 0.5 * kPi);
      EXPECT_LE(std::abs(model.X_PM.y), 1.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, SpawnTest, testing::Range(0, 5));

std::vector<Pose> SpawnedPoses(const std::string& text, const LoadOverrides& overrides = {}) {
  std::vector<Pose> poses;
  for (const ModelDescription& model : MustLoad(text, overrides).world.models) {
    if (model.name[0] == 's' && std::isdigit(model.name[1])) poses.push_back(model.X_PM);
  }
  return poses;
}

TEST(Spawn, TheSeedDecidesThePlaces) {
  const std::vector<Pose> first = SpawnedPoses(SpawnText("1"));
  ASSERT_GE(first.size(), 60u);
  EXPECT_EQ(first, SpawnedPoses(SpawnText("1")));
  EXPECT_NE(first, SpawnedPoses(SpawnText("2")));
  LoadOverrides overrides;
  overrides.seed = 1;
  EXPECT_EQ(first, SpawnedPoses(SpawnText("2"), overrides));
}

TEST(Spawn, ARulesOwnSeedIsIndependentOfTheScenarios) {
  const auto text = [](int seed) {
    return R"({"seed": )" + std::to_string(seed) +
           R"(, "spawn": [{"model": "position", "count": 5, "region": [0, 0, 9, 9], "seed": 3, "name_prefix": "s"}]})";
  };
  EXPECT_EQ(SpawnedPoses(text(1)), SpawnedPoses(text(2)));
}

TEST(Spawn, LowRobotsMayStartUnderTables) {
  const LoadedWorld loaded = MustLoad(R"({
    "include": ["../include/robots.inc", "../include/furniture.inc"],
    "models": [{"name": "t", "model": "table", "pose": [0, 0, 0]}],
    "spawn": [{"model": "scout", "count": 3, "region": [-0.5, -0.1, 0.5, 0.1]}]})");
  EXPECT_EQ(loaded.world.robots.size(), 3u);
}

TEST(Spawn, ModelsStandOnTheFloorThatARuleNames) {
  const LoadedWorld loaded = MustLoad(R"({
    "include": ["../include/robots.inc"],
    "models": [{"name": "wall", "model": "model", "pose": [0, 0, 0], "properties": {"size": [9, 9, 3.5]}}],
    "spawn": [{"model": "scout", "count": 3, "region": [-2, -2, 2, 2], "z": 4}]})");
  for (const RobotDescription& robot : loaded.world.robots) EXPECT_EQ(loaded.world.model(robot.root).X_PM.z, 4.0);
}

TEST(Spawn, OdometryCountsFromWhereTheRobotIsPlaced) {
  const LoadedWorld loaded = MustLoad(R"({
    "include": ["../include/robots.inc"], "spawn": [{"model": "scout", "count": 3, "region": [5, 5, 9, 9]}]})");
  for (const RobotDescription& robot : loaded.world.robots) {
    EXPECT_EQ(robot.localization.origin, Pose{});
  }
}

// The scenarios of the repository, and the examples of the documentation.

class OwnScenario : public testing::TestWithParam<const char*> {};

TEST_P(OwnScenario, LoadsWithoutWarnings) {
  const LoadedWorld loaded = test::ValueOf(LoadScenario(WorldsFolder() + "/scenarios/" + GetParam()));
  for (const Warning& warning : loaded.warnings) ADD_FAILURE() << warning.ToString();
  EXPECT_FALSE(loaded.world.robots.empty());
  EXPECT_TRUE(Validate(loaded.world).ok());
}

INSTANTIATE_TEST_SUITE_P(Files, OwnScenario,
                         testing::Values("demo.json", "office.json", "swarm.json", "under_table.json"),
                         [](const auto& test) {
                           const std::string name = test.param;
                           return name.substr(0, name.find('.'));
                         });

TEST(Scenario, TheExamplesOfTheDocumentationLoad) {
  const std::string page =
      test::ValueOf(ReadTextFile(WorldsFolder() + "/../docs/scenarios.md", {"docs/scenarios.md", 0, 0}));
  const std::string& text = page;
  int examples = 0;
  for (std::size_t start = text.find("```json\n"); start != std::string::npos; start = text.find("```json\n", start)) {
    start += 8;
    const std::size_t end = text.find("```", start);
    const std::string example = text.substr(start, end - start);
    const Result<LoadedWorld> loaded = Load(example);
    EXPECT_TRUE(loaded.ok()) << loaded.error().ToString() << "\n" << example;
    ++examples;
    start = end;
  }
  EXPECT_GE(examples, 15);
}

}  // namespace
}  // namespace troupe
