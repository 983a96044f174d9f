// The scenarios of examples/nav2 load, agree with its parameter file, and have robots that can drive.
#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>
#include <set>
#include <string>
#include <utility>

#include "tests/support/values.h"
#include "tests/worldfile/scenario_run.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

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

}  // namespace
}  // namespace troupe
