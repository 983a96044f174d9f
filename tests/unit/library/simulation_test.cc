#include "troupe/simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/files.h"
#include "tests/support/gripper_world.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"

namespace troupe {
namespace {

using ::testing::HasSubstr;

Simulation Create(const WorldDescription& world, const SimulationOptions& options = {}) {
  Result<Simulation> simulation = Simulation::Create(world, options);
  if (!simulation.ok()) ADD_FAILURE() << simulation.error().ToString();
  return std::move(simulation).value();
}

// One robot with one ray, 2.5 m in front of a wall.
class SimulationTest : public ::testing::Test {
 protected:
  SimulationTest() {
    robot_ = world_.AddRobot("r0", {});
    world_.AddRanger(robot_, {}, {OneRay()});
    world_.AddBox("wall", 3.0, 0.0, 1.0, 9.0, {0.0, 1.0});
    world_.SetController(robot_, "script", R"({"commands": [{"at": 0, "vx": 0.5}]})");
  }

  SmallWorld world_;
  RobotId robot_;
};

TEST_F(SimulationTest, StepsByTicksAndReportsTimePoseAndEvents) {
  Simulation simulation = Create(world_.world());
  EXPECT_EQ(simulation.tick(), 0u);
  EXPECT_EQ(simulation.pose(robot_), Pose());
  simulation.Step(10);
  EXPECT_EQ(simulation.tick(), 10u);
  EXPECT_DOUBLE_EQ(simulation.time(), 1.0);
  EXPECT_NEAR(simulation.pose(robot_).x, 0.5, 1e-9);
  EXPECT_TRUE(simulation.events().empty());
  while (simulation.events().empty() && simulation.tick() < 100) simulation.Step();
  ASSERT_EQ(simulation.events().size(), 1u);  // of the last tick alone
  EXPECT_EQ(simulation.events()[0].type, EventType::kStallBegan);
  EXPECT_EQ(simulation.events()[0].tick, simulation.tick());
  EXPECT_NEAR(simulation.pose(robot_).x, 2.3, 2e-3);
  simulation.Step();
  EXPECT_TRUE(simulation.events().empty());
}

TEST_F(SimulationTest, MeasuresThePresentStateWithoutChangingTheRun) {
  Simulation read = Create(world_.world());
  Simulation unread = Create(world_.world());
  for (int i = 0; i < 20; ++i) {
    const SensorReading reading = read.Measure(robot_, 0);
    EXPECT_EQ(reading.tick, read.tick());
    EXPECT_NEAR(reading.ranger()->ranges.at(0), 2.5 - read.pose(robot_).x, 1e-9);
    read.Step();
    unread.Step();
    ASSERT_EQ(read.state_hash(), unread.state_hash());
  }
}

TEST_F(SimulationTest, MeasuresASensorThatTheControllerReadsInThePresentState) {
  world_.SetController(robot_, "wander", "{}");
  Simulation simulation = Create(world_.world());
  const auto measure = [this, &simulation] {
    const SensorReading reading = simulation.Measure(robot_, 0);
    EXPECT_EQ(reading.tick, simulation.tick());
    return reading.ranger()->ranges.at(0);
  };
  EXPECT_NEAR(measure(), 2.5, 1e-9);
  const Result<Snapshot> start = simulation.Save();
  ASSERT_TRUE(start.ok());
  simulation.Step(10);
  EXPECT_GT(simulation.pose(robot_).x, 0.1);
  EXPECT_NEAR(measure(), 2.5 - simulation.pose(robot_).x, 1e-9);
  ASSERT_TRUE(simulation.Restore(start.value()).ok());
  EXPECT_NEAR(measure(), 2.5, 1e-9);
}

TEST_F(SimulationTest, ACommandFromOutsideReplacesTheControllersUntilItIsReleased) {
  Simulation simulation = Create(world_.world());
  ASSERT_TRUE(simulation.Drive(robot_, {.twist = {-0.2, 0.0, 0.0}}).ok());
  simulation.Step(10);
  EXPECT_NEAR(simulation.pose(robot_).x, -0.2, 1e-9);
  simulation.Release(robot_);
  simulation.Step(10);
  EXPECT_NEAR(simulation.pose(robot_).x, 0.3, 1e-9);
}

TEST_F(SimulationTest, ATextOfACommandFromOutsideIsSaidOnce) {
  Simulation simulation = Create(world_.world());
  Tick said = 0;
  const auto step = [&] {
    simulation.Step();
    for (const Event& event : simulation.events()) said += event.type == EventType::kSaid && event.detail == "here";
  };
  ASSERT_TRUE(simulation.Drive(robot_, {.twist = {-0.2, 0.0, 0.0}, .say = "here"}).ok());
  for (int i = 0; i < 10; ++i) step();
  EXPECT_EQ(said, 1u);
  EXPECT_NEAR(simulation.pose(robot_).x, -0.2, 1e-9) << "the motion lasts";
  ASSERT_TRUE(simulation.Drive(robot_, {.say = "here"}).ok());
  for (int i = 0; i < 3; ++i) step();
  EXPECT_EQ(said, 2u);
}

TEST_F(SimulationTest, RejectsCommandsThatTheRobotCannotExecute) {
  Simulation simulation = Create(world_.world());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    Command command;
    const char* message;
  } cases[] = {
      {{.twist = {nan, 0.0, 0.0}}, "robot r0: found a motion with a number that is not finite"},
      {{.steering = INFINITY}, "robot r0: found a motion with a number that is not finite"},
      {{.grippers = {{.gripper = 0, .fingers = FingerCommand::kClose}}}, "robot r0: commands gripper 0"},
      {{.joints = {{.joint = 2, .position = 0.0}}}, "robot r0: commands joint 2"},
  };
  for (const auto& c : cases) {
    const Status status = simulation.Drive(robot_, c.command);
    ASSERT_FALSE(status.ok()) << c.message;
    EXPECT_THAT(status.error().message, HasSubstr(c.message));
  }
  simulation.Step(10);
  EXPECT_NEAR(simulation.pose(robot_).x, 0.5, 1e-9) << "a rejected command changed something";
}

TEST_F(SimulationTest, WithoutControllersARobotStandsStillUntilItIsDriven) {
  world_.SetController(robot_, "/no/such/library.so");
  EXPECT_FALSE(Simulation::Create(world_.world()).ok());
  Simulation simulation = Create(world_.world(), {.seed = {}, .controller = {}, .run_controllers = false});
  simulation.Step(5);
  EXPECT_EQ(simulation.pose(robot_), Pose());
  ASSERT_TRUE(simulation.Drive(robot_, {.twist = {0.1, 0.0, 0.0}}).ok());
  simulation.Step(10);
  EXPECT_NEAR(simulation.pose(robot_).x, 0.1, 1e-9);
}

TEST_F(SimulationTest, ReportsAControllerThatFailedOnce) {
  world_.SetController(robot_, TEST_LIBRARY_FOLDER "/libcontroller_throws_later.so");
  Simulation simulation = Create(world_.world());
  simulation.Step(3);
  EXPECT_TRUE(simulation.failures().empty());
  simulation.Step(10);
  ASSERT_EQ(simulation.failures().size(), 1u);
  EXPECT_THAT(simulation.failures()[0], HasSubstr("failed at tick 3: out of ideas"));
}

TEST_F(SimulationTest, RefusesADescriptionThatIsNotValid) {
  world_.world().robots[0].root = ModelId(99);
  EXPECT_FALSE(Simulation::Create(world_.world()).ok());
}

TEST(SimulationLoad, NamesThePlaceInABadFile) {
  EXPECT_THAT(Simulation::Load("missing.world").error().ToString(), HasSubstr("missing.world"));
  const test::TemporaryFolder folder;
  const std::string file = folder.Write(
      "bad.world", "define robot position ( size [0.4 0.4 0.3] )\nrobot( name \"r\" pose [0 0 0 zero] )\n");
  EXPECT_THAT(Simulation::Load(file).error().ToString(), HasSubstr(file + ":2:"));
}

TEST(SimulationLoad, OptionsReplaceSeedAndMissingControllers) {
  const test::TemporaryFolder folder;
  const std::string file =
      folder.Write("r.world", "define robot position ( size [0.4 0.4 0.3] )\nrobot( name \"r\" )\n");
  const Simulation simulation = test::ValueOf(Simulation::Load(file, {.seed = 77, .controller = "wander"}));
  EXPECT_EQ(simulation.world().seed, 77u);
  ASSERT_EQ(simulation.world().robots.size(), 1u);
  EXPECT_EQ(simulation.world().robots[0].controller.name, "wander");
}

TEST(SimulationObjects, ReportsTheObjectThatAGripperHolds) {
  test::GripperWorld yard;
  const test::GripperRobot robot = yard.AddGripperRobot({});
  yard.AddObject({0.35, 0.0, 0.0, 0.0});
  Simulation simulation = Create(yard.world);
  EXPECT_THAT(simulation.HeldObjects(robot.robot), testing::ElementsAre(std::nullopt));
  ASSERT_TRUE(simulation.Drive(robot.robot, {.grippers = {{.fingers = FingerCommand::kClose}}}).ok());
  simulation.Step(40);
  EXPECT_THAT(simulation.HeldObjects(robot.robot), testing::ElementsAre(yard.world.objects[0]));
}

TEST_F(SimulationTest, SavesPicturesByTheFilesEnding) {
  Simulation simulation = Create(world_.world());
  const test::TemporaryFolder folder;
  const std::string stem = folder.Path("picture");
  ASSERT_TRUE(simulation.SavePicture(stem + ".png").ok());
  EXPECT_THAT(test::TextOf(stem + ".png"), HasSubstr("PNG"));
  ASSERT_TRUE(simulation.SavePicture(stem + ".svg").ok());
  const std::string plain = test::TextOf(stem + ".svg");
  EXPECT_THAT(plain, HasSubstr("<svg"));
  ASSERT_TRUE(simulation.SavePicture(stem + ".svg", {}, PictureRays::kDrawn).ok());
  EXPECT_NE(test::TextOf(stem + ".svg"), plain);

  EXPECT_EQ(simulation.SavePicture(stem + ".gif").error().code, ErrorCode::kBadInput);
  EXPECT_EQ(simulation.SavePicture("/no/such/folder/x.png").error().code, ErrorCode::kOutputFailed);
  PictureOptions narrow;
  narrow.width = 3;
  EXPECT_EQ(simulation.SavePicture(stem + ".png", narrow).error().code, ErrorCode::kBadInput);
}

// Snapshots: the same steps from one give the same hashes, regardless of the steps in between.

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

TEST_F(SimulationTest, ChangesFromOutsideAreThoseOfARun) {
  SmallWorld small;
  const RobotId first = small.AddRobot("first", {});
  small.AddBox("wall", 3.0, 0.0, 1.0, 9.0, {0.0, 1.0});
  small.SetController(first, "go_to", "{}");
  Simulation simulation = Create(small.world());
  EXPECT_THAT(simulation.SendTo(first, {}).error().message, HasSubstr("found a goal with 0 points"));
  EXPECT_THAT(simulation.SendTo(first, {.waypoints = {{3.0, 0.0}}}).error().message,
              HasSubstr("cannot reach the goal"));
  EXPECT_TRUE(simulation.SendTo(first, {.waypoints = {{-1.0, 0.0}}}).ok());
  simulation.Step(60);
  EXPECT_NEAR(simulation.pose(first).x, -1.0, 0.2);

  EXPECT_THAT(simulation.SetPose("first", {3.0, 0.0, 0.0, 0.0}).error().message, HasSubstr("would be inside 'wall'"));
  EXPECT_TRUE(simulation.SetPose("first", {0.0, 1.0, 0.0, 0.0}).ok());
  EXPECT_EQ(simulation.FindPose("first").value(), simulation.pose(first));
  EXPECT_EQ(simulation.FindPose("second").error().code, ErrorCode::kBadInput);
  EXPECT_TRUE(simulation.AddInput({first, TwistOrder{{0.5, 0.0, 0.0}}}).ok());
  EXPECT_FALSE(simulation.AddInput({{}, DoorOrder{0, 1.0}}).ok());
  simulation.CancelGoal(first);
  simulation.Step();
  EXPECT_GT(simulation.state().robots[0].twist.vx, 0.0);

  const Result<Snapshot> saved = simulation.Save();
  ASSERT_TRUE(saved.ok());
  // A world from memory has no file with models.
  EXPECT_FALSE(simulation.Spawn("position", {0.0, -2.0, 0.0, 0.0}).ok());
  EXPECT_TRUE(simulation.Delete("first").ok());
  simulation.Step(5);
  EXPECT_FALSE(simulation.FindPose("first").ok());
  const std::uint64_t hash = simulation.state_hash();
  ASSERT_TRUE(simulation.Restore(saved.value()).ok());
  EXPECT_TRUE(simulation.FindPose("first").ok());
  EXPECT_NE(simulation.state_hash(), hash);
}

TEST(SimulationText, IsAScenarioWithTheModelsThatItNames) {
  const std::string text =
      R"({"include": ["robots.inc"], "robots": [{"name": "a", "model": "scout", "pose": [0, 0, 0]}]})";
  const std::string path = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/include/none.json";
  Result<Simulation> simulation = Simulation::LoadScenario(text, path);
  ASSERT_TRUE(simulation.ok()) << simulation.error().ToString();
  const Result<std::string> spawned = simulation.value().Spawn("scout", {1.0, 1.0, 0.0, 0.0});
  ASSERT_TRUE(spawned.ok()) << spawned.error().ToString();
  EXPECT_EQ(spawned.value(), "scout");
  EXPECT_EQ(simulation.value().Spawn("scout", {-1.0, 1.0, 0.0, 0.0}).value(), "scout0");
  simulation.value().Step(3);
  EXPECT_EQ(simulation.value().world().robots.size(), 3u);
  const Result<Simulation> bad = Simulation::LoadScenario(R"({"robotos": []})", path);
  EXPECT_EQ(bad.error().where.file, path);
}

}  // namespace
}  // namespace troupe
