// Whole scenarios, with sensors and controllers, compared with recorded hashes: a change that moves any robot by
// one bit in any tick shows here. A commit that intends such a change gives the reason, and replaces the hashes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/model/states.h"
#include "tests/support/stage_worlds.h"
#include "tests/worldfile/scenario_run.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

std::string SourceDirectory() {
  const char* source = std::getenv("TROUPE_SOURCE_DIR");
  return source != nullptr ? source : ".";
}

WorldState StateAfter(const std::string& scenario, int ticks) {
  Result<LoadedWorld> loaded = LoadWorld(SourceDirectory() + "/worlds/scenarios/" + scenario);
  EXPECT_TRUE(loaded.ok()) << loaded.error().ToString();
  if (!loaded.ok()) return {};
  ScenarioRun run(std::move(loaded).value().world);
  run.Run(ticks);
  return run.state();
}

// The hash of the robots' states, without the objects.
std::uint64_t HashAfter(const std::string& scenario, int ticks) {
  WorldState state = StateAfter(scenario, ticks);
  state.objects.clear();
  return StateHash(state);
}

TEST(ScenarioHash, TheOfficeIsTheSameAsEver) {
  EXPECT_EQ(HashAfter("office.json", 400), 0xa52348b41a331c90u);
}

TEST(ScenarioHash, TheDemoIsTheSameAsEver) {
  EXPECT_EQ(StateHash(StateAfter("demo.json", 800)), 0x75d8855c27633becu);
}

TEST(ScenarioHash, TheSwarmIsTheSameAsEver) {
  EXPECT_EQ(HashAfter("swarm.json", 100), 0x3d412aa6db4f89c4u);
}

TEST(ScenarioHash, ScenariosWithGrippersAreTheSameAsEver) {
  EXPECT_EQ(StateHash(StateAfter("stacking.json", 1000)), 0x114874baa4473720u);
  EXPECT_EQ(StateHash(StateAfter("marina.json", 700)), 0xb5da5412597f448du);
  EXPECT_EQ(StateHash(StateAfter("lab.json", 450)), 0x8d1da5bfc7d57d2bu);
  EXPECT_EQ(StateHash(StateAfter("relay.json", 1400)), 0x9de39134a2e3a6a5u);
}

TEST(ScenarioHash, RobotsThatTalkByRadioAreTheSameAsEver) {
  const WorldState state = StateAfter("radio.json", 300);
  EXPECT_FALSE(state.transmissions.empty());
  EXPECT_EQ(StateHash(state), 0x9d832c5eec8218c3u);
}

TEST(ScenarioHash, PeopleAreTheSameAsEver) {
  EXPECT_EQ(StateHash(StateAfter("people.json", 200)), 0x9f322a3a20f0293fu);
  EXPECT_EQ(StateHash(StateAfter("hall.json", 100)), 0x4ac68c38489ef83cu);
}

TEST(ScenarioHash, DoorsAndLiftsAreTheSameAsEver) {
  EXPECT_EQ(StateHash(StateAfter("../sites/guesthouse_lift.json", 300)), 0x9e4ba38dce58987cu);
  EXPECT_EQ(StateHash(StateAfter("hotel.json", 100)), 0xa48b7818c4f838cfu);
}

// Stage's benchmark with walls that can be hit, which its map file turns off.
TEST(SolidCave, NoRobotIsEverInsideAWallOrAnotherRobot) {
  const std::string worlds = test::StageWorldsFolder();
  if (!std::filesystem::exists(worlds + "/benchmark/cave.world")) {
    GTEST_SKIP() << "no Stage worlds in " << worlds << "; set TROUPE_STAGE_WORLDS";
  }
  const std::string scenario = testing::TempDir() + "/solid_cave.json";
  std::ofstream(scenario) << R"({"world": ")" << std::filesystem::absolute(worlds).string()
                          << R"(/benchmark/cave.world", "override": [{"match": {"name": "cave"}, )"
                          << R"("properties": {"obstacle_return": 1}}]})";
  Result<LoadedWorld> loaded = LoadWorld(scenario);
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  ScenarioRun run(std::move(loaded).value().world);
  const std::vector<RobotDescription>& robots = run.scene().world().robots;
  ASSERT_EQ(robots.size(), 100u);
  for (int tick = 0; tick < 600; tick += 20) {
    run.Run(20);
    for (const RobotDescription& robot : robots) ASSERT_FALSE(run.InsideSomething(robot.name)) << robot.name;
  }
}

}  // namespace
}  // namespace troupe
