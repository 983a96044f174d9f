// Snapshots: the same steps from one give the same hashes, regardless of the steps in between.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "tests/support/small_world.h"
#include "troupe/simulation.h"

namespace troupe {
namespace {

using ::testing::HasSubstr;

Simulation Load(const std::string& scenario) {
  const std::string path = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/scenarios/" + scenario;
  Result<Simulation> simulation = Simulation::Load(path);
  if (!simulation.ok()) ADD_FAILURE() << simulation.error().ToString();
  return std::move(simulation).value();
}

std::vector<std::uint64_t> HashesOf(Simulation& simulation, int ticks) {
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < ticks; ++i) {
    simulation.Step();
    hashes.push_back(simulation.state_hash());
  }
  return hashes;
}

struct Case {
  const char* scenario;
  Tick saved_at;
};

class SnapshotTest : public ::testing::TestWithParam<Case> {};

TEST_P(SnapshotTest, StepsFromItGiveTheSameHashes) {
  constexpr int kTicks = 150;
  Simulation simulation = Load(GetParam().scenario);
  simulation.Step(GetParam().saved_at);
  const Result<Snapshot> snapshot = simulation.Save();
  ASSERT_TRUE(snapshot.ok()) << snapshot.error().ToString();
  EXPECT_EQ(snapshot.value().tick(), GetParam().saved_at);
  const std::uint64_t saved_hash = simulation.state_hash();
  const std::vector<std::uint64_t> hashes = HashesOf(simulation, kTicks);

  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(simulation.Restore(snapshot.value()).ok());
    EXPECT_EQ(simulation.tick(), GetParam().saved_at);
    EXPECT_EQ(simulation.state_hash(), saved_hash);
    EXPECT_EQ(HashesOf(simulation, kTicks), hashes) << "round " << round;
  }

  Simulation other = Load("under_table.json");
  other.Step(7);
  ASSERT_TRUE(other.Restore(snapshot.value()).ok());
  EXPECT_EQ(HashesOf(other, kTicks), hashes) << "in another simulation";
}

// Rangers and odometry with noise; grippers on their way, holding and stacking.
INSTANTIATE_TEST_SUITE_P(Scenarios, SnapshotTest,
                         ::testing::Values(Case{"demo.json", 0}, Case{"demo.json", 123}, Case{"stacking.json", 260},
                                           Case{"marina.json", 215}, Case{"lab.json", 100}, Case{"relay.json", 600}),
                         [](const auto& given) {
                           const std::string name = given.param.scenario;
                           return name.substr(0, name.find('.')) + "_" + std::to_string(given.param.saved_at);
                         });

class DrivenSnapshotTest : public ::testing::Test {
 protected:
  DrivenSnapshotTest() { robot_ = world_.AddRobot("r0", {}); }
  Simulation Create() {
    Result<Simulation> simulation = Simulation::Create(world_.world());
    if (!simulation.ok()) ADD_FAILURE() << simulation.error().ToString();
    return std::move(simulation).value();
  }

  SmallWorld world_;
  RobotId robot_;
};

TEST_F(DrivenSnapshotTest, ContainsTheCommandFromOutside) {
  Simulation simulation = Create();
  ASSERT_TRUE(simulation.Drive(robot_, {.twist = {0.5, 0.0, 0.0}}).ok());
  simulation.Step(2);
  const Snapshot snapshot = simulation.Save().value();
  simulation.Release(robot_);
  simulation.Step(5);
  ASSERT_TRUE(simulation.Restore(snapshot).ok());
  simulation.Step(8);
  EXPECT_NEAR(simulation.pose(robot_).x, 0.5, 1e-9);
}

TEST_F(DrivenSnapshotTest, OutlivesItsSimulation) {
  std::optional<Snapshot> snapshot;
  {
    Simulation simulation = Create();
    simulation.Step(4);
    snapshot = simulation.Save().value();
  }
  Simulation simulation = Create();
  ASSERT_TRUE(simulation.Restore(*snapshot).ok());
  EXPECT_EQ(simulation.tick(), 4u);
  simulation.Step();
  EXPECT_EQ(simulation.tick(), 5u);
}

TEST_F(DrivenSnapshotTest, IsRefusedWhereAControllerCannotBeCopied) {
  world_.SetController(robot_, TEST_LIBRARY_FOLDER "/libcontroller_good.so");
  Simulation simulation = Create();
  simulation.Step();
  const Result<Snapshot> snapshot = simulation.Save();
  ASSERT_FALSE(snapshot.ok());
  EXPECT_THAT(snapshot.error().message, HasSubstr("robot r0: controller"));
  EXPECT_THAT(snapshot.error().message, HasSubstr("cannot be copied"));
  simulation.Step();  // continues as before
  EXPECT_EQ(simulation.tick(), 2u);
}

}  // namespace
}  // namespace troupe
