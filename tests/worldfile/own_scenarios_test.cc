// The scenarios of worlds/scenarios behave as intended.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "tests/support/values.h"
#include "tests/worldfile/scenario_run.h"
#include "worldfile/load_world.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

ScenarioRun Load(const std::string& name) {
  const std::string path = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/scenarios/" + name;
  Result<LoadedWorld> loaded = LoadScenario(path);
  EXPECT_TRUE(loaded.ok()) << loaded.error().ToString();
  return ScenarioRun(loaded.ok() ? std::move(loaded).value().world : WorldDescription{});
}

// What a visitor sees in the first two minutes.
TEST(DemoScenario, RobotsReachTheirGoalsAndAGripperBuildsATower) {
  ScenarioRun run = Load("demo.json");
  std::map<std::string, std::vector<Vec2>> rounds = {{"anna", {{0.0, -7.2}, {-8.0, -6.5}, {-8.0, 0.0}}},
                                                     {"fina", {{10.0, 1.9}, {2.2, 1.9}, {2.2, 5.05}}}};
  double highest = 0.0;  // of a cube
  for (int i = 0; i < 120; ++i) {
    run.Run(10);
    for (auto& [robot, waypoints] : rounds) {
      if (!waypoints.empty() && (run[robot].X_WR.translation() - waypoints.front()).norm() < 0.5) {
        waypoints.erase(waypoints.begin());
      }
    }
    for (const RobotDescription& robot : run.scene().world().robots) {
      EXPECT_FALSE(run.InsideSomething(robot.name)) << robot.name << " at tick " << run.state().tick;
    }
    for (const ObjectState& object : run.state().objects) {
      if (object.mode == ObjectMode::kResting && object.X_WO.x < -9.0) highest = std::max(highest, object.X_WO.z);
    }
  }
  for (const auto& [robot, waypoints] : rounds) EXPECT_TRUE(waypoints.empty()) << robot;
  EXPECT_NEAR(highest, 0.4, 1e-6);        // three cubes of 20 cm
  EXPECT_FALSE(run.EverStalled("bela"));  // waits for a goal
}

TEST(OfficeScenario, EveryRobotDrivesAndNoneIsEverInsideAWall) {
  ScenarioRun run = Load("office.json");
  const std::vector<RobotDescription>& robots = run.scene().world().robots;
  ASSERT_EQ(robots.size(), 8u);
  std::vector<double> farthest(robots.size(), 0.0);
  const WorldState start = run.state();
  for (int i = 0; i < 40; ++i) {
    run.Run(10);
    for (std::size_t r = 0; r < robots.size(); ++r) {
      EXPECT_FALSE(run.InsideSomething(robots[r].name)) << robots[r].name << " at tick " << run.state().tick;
      const Vec2 moved = run.state().robots[r].X_WR.translation() - start.robots[r].X_WR.translation();
      farthest[r] = std::max(farthest[r], moved.norm());
    }
  }
  for (std::size_t r = 0; r < robots.size(); ++r) EXPECT_GT(farthest[r], 1.0) << robots[r].name;
}

TEST(OfficeScenario, ScoutsDriveUnderTablesToAndFroWithoutAStall) {
  ScenarioRun run = Load("office.json");
  run.Run(75);
  EXPECT_GT(run["carl"].X_WR.x, -0.9);  // beyond the table at -2
  EXPECT_GT(run["dora"].X_WR.x, 7.2);   // under the far end of the table at 6
  run.Run(300);
  EXPECT_FALSE(run.EverStalled("carl"));
  EXPECT_FALSE(run.EverStalled("dora"));
}

// In a minute of wandering each kind of sensor finds something.
TEST(SensorsScenario, EveryKindOfSensorFindsSomething) {
  ScenarioRun run = Load("sensors.json");
  std::vector<std::unique_ptr<const Sensor>> sensors = MakeSensors(run.scene(), run.Find("scout"));
  for (auto& sensor : MakeSensors(run.scene(), run.Find("blind"))) sensors.push_back(std::move(sensor));
  std::map<std::string, int> found;
  const auto count = [&](const SensorReading& reading, const std::string& name) {
    bool any = false;
    if (const auto* const fiducials = reading.As<FiducialReading>()) any = !fiducials->fiducials.empty();
    if (const auto* const blobs = reading.As<BlobfinderReading>()) any = !blobs->blobs.empty();
    if (const auto* const contacts = reading.As<ContactReading>()) any = !contacts->contacts.empty();
    if (const auto* const bumper = reading.As<BumperReading>()) {
      for (const BumperReading::Segment& segment : bumper->segments) any = any || segment.pressed_by.has_value();
    }
    if (const auto* const view = reading.As<CameraReading>()) {
      any = std::any_of(view->models.begin(), view->models.end(), [](std::int32_t model) { return model >= 0; });
    }
    if (const RangerReading* const ranger = reading.ranger()) {
      const RangeScan scan = ranger->scan(0);
      any = std::any_of(scan.ranges.begin(), scan.ranges.end(), [&](double r) { return r < scan.limits.max; });
    }
    if (const auto* const imu = reading.As<ImuReading>()) any = imu->turn != 0.0 && imu->force_xy.norm() > 0.0;
    found[name] += any ? 1 : 0;
  };
  BodyIndex bodies(run.scene());
  for (int tick = 0; tick < 600; ++tick) {
    run.Run(1);
    bodies.Assign(run.state());
    for (const auto& sensor : sensors) {
      if (tick % 4 == 0)
        count(sensor->Measure({run.scene(), bodies, &run.state()}, run.state().tick), sensor->description().name);
    }
  }
  for (const auto& sensor : sensors) EXPECT_GT(found[sensor->description().name], 0) << sensor->description().name;
}

TEST(SwarmScenario, SpreadsWithoutARobotInsideAnything) {
  ScenarioRun run = Load("swarm.json");
  const std::vector<RobotDescription>& robots = run.scene().world().robots;
  ASSERT_EQ(robots.size(), 100u);
  for (int i = 0; i < 4; ++i) {
    run.Run(25);
    for (const RobotDescription& robot : robots) {
      EXPECT_FALSE(run.InsideSomething(robot.name)) << robot.name << " at tick " << run.state().tick;
    }
  }
}

// Buildings with robots and people: worlds/sites.

struct SiteCase {
  const char* file;
  std::size_t robots;
  std::size_t people;
  Vec2 size;                                 // m, of the building, from the origin
  std::vector<double> levels;                // m
  std::map<std::string, double> passengers;  // robots that take a lift, and a level to which it brings them
};

class SiteScenario : public testing::TestWithParam<SiteCase> {};

TEST_P(SiteScenario, LoadsWithoutWarningsAndLosesNothingBetweenItsLevels) {
  const SiteCase& site = GetParam();
  const std::string path = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/scenarios/" + site.file;
  LoadedWorld loaded = test::ValueOf(LoadScenario(path));
  for (const Warning& warning : loaded.warnings) ADD_FAILURE() << warning.ToString();
  ScenarioRun run(std::move(loaded.world));
  ASSERT_EQ(run.state().robots.size(), site.robots);
  ASSERT_EQ(run.state().people.size(), site.people);
  const WorldState start = run.state();
  const auto is_on_a_level = [&](const Pose& pose) {
    return std::count(site.levels.begin(), site.levels.end(), pose.z) == 1 && pose.x > 0.0 && pose.y > 0.0 &&
           pose.x < site.size.x() && pose.y < site.size.y();
  };
  double walked = 0.0;
  for (int i = 0; i < 5; ++i) {
    run.Run(50);
    for (std::size_t r = 0; r < site.robots; ++r) {
      const std::string& name = run.scene().world().robots[r].name;
      const Pose& pose = run.state().robots[r].X_WR;
      // A cabin passes through the floors.
      const bool rides = site.passengers.contains(name) && !is_on_a_level(pose);
      if (!rides) {
        EXPECT_FALSE(run.InsideSomething(name)) << name << " at tick " << run.state().tick;
      }
      if (!site.passengers.contains(name)) {
        EXPECT_TRUE(is_on_a_level(pose) && pose.z == start.robots[r].X_WR.z) << name;
      }
    }
    for (std::size_t p = 0; p < site.people; ++p) {
      const Pose& pose = run.state().people[p].X_WP;
      EXPECT_TRUE(run.state().people[p].lift != 0 || is_on_a_level(pose)) << p;
      walked += (pose.translation() - start.people[p].X_WP.translation()).norm();
    }
  }
  EXPECT_GT(walked / (5.0 * static_cast<double>(site.people)), 2.0);
  std::set<std::string> arrived;
  for (int i = 0; i < 20 && arrived.size() < site.passengers.size(); ++i) {
    run.Run(50);
    for (const auto& [name, z] : site.passengers) {
      if (run[name].X_WR.z == z) arrived.insert(name);
    }
  }
  for (const auto& [name, z] : site.passengers)
    EXPECT_TRUE(arrived.contains(name)) << name << " does not arrive at " << z;
}

INSTANTIATE_TEST_SUITE_P(
    Sites, SiteScenario,
    testing::Values(SiteCase{"hotel.json", 100, 200, {48, 24}, {0, 4, 8}, {{"tiny_1", 4}, {"tiny_2", 0}}},
                    SiteCase{"clinic.json", 40, 100, {36, 18}, {0, 4.5}, {{"nurse_1", 4.5}, {"nurse_2", 0}}},
                    SiteCase{"airport.json", 60, 300, {120, 40}, {0}, {}}),
    [](const auto& test) {
      const std::string file = test.param.file;
      return file.substr(0, file.find('.'));
    });

// The scenarios of examples/nav2 load, agree with its parameter file, and have robots that can drive.

std::string ExamplePath(const std::string& name) {
  return std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/examples/nav2/" + name;
}

LoadedWorld LoadExample(const std::string& name) {
  Result<LoadedWorld> loaded = LoadScenario(ExamplePath(name));
  EXPECT_TRUE(loaded.ok()) << loaded.error().ToString();
  return loaded.ok() ? std::move(loaded).value() : LoadedWorld{};
}

class Nav2Example : public testing::TestWithParam<const char*> {};

TEST_P(Nav2Example, LoadsWithoutWarningsAndItsRobotsDrive) {
  LoadedWorld loaded = LoadExample(GetParam());
  for (const Warning& warning : loaded.warnings) ADD_FAILURE() << warning.ToString();
  EXPECT_TRUE(loaded.settings.ros);
  ASSERT_FALSE(loaded.world.robots.empty());
  for (RobotDescription& robot : loaded.world.robots) {
    EXPECT_EQ(robot.controller.name, "idle") << "Nav2 commands it";
    robot.controller.name = "wander";
  }
  ScenarioRun run(std::move(loaded.world));
  const WorldState start = run.state();
  run.Run(200);  // 10 s
  for (const RobotDescription& robot : run.scene().world().robots) {
    const RobotId id = run.Find(robot.name);
    const Vec2 moved = run[robot.name].X_WR.translation() - start.robots[id.index()].X_WR.translation();
    EXPECT_GT(moved.norm(), 1.0) << robot.name;
    EXPECT_FALSE(run.EverStalled(robot.name)) << robot.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Nav2Example, testing::Values("one.json", "drift.json", "three.json"),
                         [](const auto& test) {
                           const std::string name = test.param;
                           return name.substr(0, name.find('.'));
                         });

TEST(Nav2Files, EachOfThreeRobotsHasADomain) {
  const LoadedWorld loaded = LoadExample("three.json");
  std::set<std::uint32_t> domains;
  for (const RobotDescription& robot : loaded.world.robots) {
    ASSERT_TRUE(robot.ros.domain.has_value()) << robot.name;
    domains.insert(*robot.ros.domain);
  }
  EXPECT_EQ(domains, (std::set<std::uint32_t>{11, 12, 13})) << "those of the README";
}

// AMCL starts where the robot does.
TEST(Nav2Files, TheInitialPoseOfTheParametersIsThatOfTheRobotWithDrift) {
  const LoadedWorld loaded = LoadExample("drift.json");
  ASSERT_EQ(loaded.world.robots.size(), 1u);
  const RobotDescription& robot = loaded.world.robots[0];
  EXPECT_EQ(robot.localization.type, LocalizationType::kOdometry);
  const std::string parameters = test::ValueOf(ReadTextFile(ExamplePath("params.yaml"), {"params.yaml", 0, 0}));
  std::smatch pose;
  ASSERT_TRUE(std::regex_search(
      parameters, pose, std::regex(R"(initial_pose: \{x: ([-.0-9]+), y: ([-.0-9]+), z: 0\.0, yaw: ([-.0-9]+)\})")));
  const ScenarioRun run(loaded.world);
  EXPECT_EQ(std::stod(pose[1]), run[robot.name].X_WR.x);
  EXPECT_EQ(std::stod(pose[2]), run[robot.name].X_WR.y);
  EXPECT_EQ(std::stod(pose[3]), run[robot.name].X_WR.heading);
}

// Stage's own gripper on the stacking script that Stage cannot execute: worlds/scenarios/stage_stacking.json.
TEST(StageStacking, StacksTheBoxInThePoseInWhichItWasGripped) {
  const char* source = std::getenv("TROUPE_SOURCE_DIR");
  Result<LoadedWorld> loaded =
      LoadWorld(std::string(source != nullptr ? source : ".") + "/worlds/scenarios/stage_stacking.json");
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  ScenarioRun run(std::move(loaded.value().world));
  const ObjectId box(0);
  const auto state = [&]() -> const ObjectState& { return run.state().objects[box.index()]; };
  const Pose start = state().X_WO;
  run.Run(40);
  EXPECT_EQ(state().mode, ObjectMode::kHeld);
  EXPECT_EQ(state().X_WO, start) << "gripped where it is, as it is turned";
  run.Run(40);
  EXPECT_NEAR(state().X_WO.z, 0.18, 1e-9) << "lifted by the part of the gripper's height above its paddles";
  run.Run(130);
  EXPECT_EQ(state().mode, ObjectMode::kResting);
  EXPECT_EQ(state().X_WO.z, 0.1);
  EXPECT_NEAR(state().X_WO.x, 1.41, 1e-9);
  EXPECT_EQ(state().support, run.scene().world().objects[1]);
  EXPECT_LT(run["r"].X_WR.x, 0.0) << "the robot has backed off";
}

}  // namespace
}  // namespace troupe
