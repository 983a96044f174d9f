#include <gtest/gtest.h>

#include "tests/unit/controller/controlled_robot.h"

namespace troupe {
namespace {

std::unique_ptr<Controller> MakeScript(const RobotDescription& robot) {
  Result<std::unique_ptr<Controller>> controller = CreateFor(robot);
  EXPECT_TRUE(controller.ok()) << controller.error().message;
  return std::move(controller).value();
}

double SpeedAt(Controller& controller, Tick tick) {
  return controller.Update(At(tick, {})).twist.vx;
}

TEST(ScriptTest, HoldsEachCommandUntilTheNext) {
  const RobotDescription robot = MakeRobot(
      "script", R"({"commands": [{"at": 0.3, "vx": 1, "wz": -2}, {"at": 0.7, "vx": 2}, {"at": 1, "wz": 3}]})");
  const auto script = MakeScript(robot);
  EXPECT_EQ(SpeedAt(*script, 0), 0.0);  // nothing yet
  EXPECT_EQ(SpeedAt(*script, 2), 0.0);
  EXPECT_EQ(SpeedAt(*script, 3), 1.0);  // due in its own tick, in spite of rounding
  EXPECT_EQ(script->Update(At(6, {})).twist.wz, -2.0);
  EXPECT_EQ(SpeedAt(*script, 7), 2.0);
  EXPECT_EQ(script->Update(At(7, {})).twist.wz, 0.0);  // what a command does not name is zero
  EXPECT_EQ(script->Update(At(1000, {})).twist, (Twist{0.0, 0.0, 3.0}));
}

TEST(ScriptTest, RepeatsFromTheTimeOfTheLastCommand) {
  const RobotDescription robot =
      MakeRobot("script", R"({"commands": [{"at": 0, "vx": 1}, {"at": 0.3, "vx": 2}, {"at": 0.5}], "repeat": true})");
  const auto script = MakeScript(robot);
  for (Tick start : {0, 5, 500}) {
    EXPECT_EQ(SpeedAt(*script, start), 1.0);
    EXPECT_EQ(SpeedAt(*script, start + 2), 1.0);
    EXPECT_EQ(SpeedAt(*script, start + 3), 2.0);
    EXPECT_EQ(SpeedAt(*script, start + 4), 2.0);
  }
}

TEST(ScriptTest, RepeatsWithAPeriodOfItsOwn) {
  const RobotDescription robot =
      MakeRobot("script", R"({"commands": [{"at": 0, "vx": 1}, {"at": 0.3, "vx": 2}], "repeat": true, "period": 0.6})");
  const auto script = MakeScript(robot);
  EXPECT_EQ(SpeedAt(*script, 5), 2.0);
  EXPECT_EQ(SpeedAt(*script, 6), 1.0);
  EXPECT_EQ(SpeedAt(*script, 9), 2.0);
}

TEST(ScriptTest, DrivesOmniSideways) {
  const RobotDescription robot = MakeRobot("script", R"({"commands": [{"at": 0, "vy": 0.5}]})", {}, DriveType::kOmni);
  EXPECT_EQ(MakeScript(robot)->Update(At(0, {})).twist.vy, 0.5);
}

TEST(ScriptTest, DrivesCarBySpeedAndSteering) {
  const RobotDescription robot =
      MakeRobot("script", R"({"commands": [{"at": 0, "speed": 0.5, "steering": 0.1}]})", {}, DriveType::kCar);
  const Command command = MakeScript(robot)->Update(At(0, {}));
  EXPECT_EQ(command.speed, 0.5);
  EXPECT_EQ(command.steering, 0.1);
}

TEST(ScriptTest, RefusesWhatTheDriveCannotDo) {
  const auto error = [](const char* command, DriveType drive) {
    const RobotDescription robot =
        MakeRobot("script", std::string(R"({"commands": [{"at": 0}, {"at": 1, )") + command + "}]}", {}, drive);
    const auto controller = CreateFor(robot);
    return controller.ok() ? std::string() : controller.error().message;
  };
  EXPECT_EQ(error("\"vy\": 1", DriveType::kDifferential), "script: command 2: a differential drive has no 'vy'");
  EXPECT_EQ(error("\"vy\": 0", DriveType::kDifferential), "");
  EXPECT_EQ(error("\"speed\": 1", DriveType::kOmni),
            "script: command 2: only a car is driven by 'speed' and 'steering', expected 'vx', 'vy' and 'wz'");
  EXPECT_EQ(error("\"vx\": 1", DriveType::kCar),
            "script: command 2: a car is driven by 'speed' and 'steering', not by 'vx', 'vy' and 'wz'");
}

}  // namespace
}  // namespace troupe
