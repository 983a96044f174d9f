#include <gtest/gtest.h>

#include <array>
#include <cmath>

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
  EXPECT_EQ(script->Update(At(7, {})).twist.wz, 0.0);  // a motion without a value is zero
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

TEST(ScriptTest, SaysATextOnce) {
  const RobotDescription robot = MakeRobot("script", R"({"commands": [{"at": 0.2, "say": "here I am"}]})");
  const auto script = MakeScript(robot);
  EXPECT_EQ(script->Update(At(1, {})).say, "");
  EXPECT_EQ(script->Update(At(2, {})).say, "here I am");
  EXPECT_EQ(script->Update(At(3, {})).say, "");
}

TEST(ScriptTest, TurnsACameraOnce) {
  RobotDescription robot =
      MakeRobot("script", R"({"commands": [{"at": 0.2, "cameras": {"eye": {"pan": 0.5, "tilt": -0.25}}}]})");
  robot.sensors.push_back({.name = "scan", .parameters = RangerParameters{}});
  robot.sensors.push_back({.name = "eye", .parameters = CameraParameters{}});
  const auto script = MakeScript(robot);
  EXPECT_TRUE(script->Update(At(1, {})).cameras.empty());
  const std::vector<CameraCommand> turns = script->Update(At(2, {})).cameras;
  ASSERT_EQ(turns.size(), 1u);
  EXPECT_EQ(turns[0].sensor, 1u);
  EXPECT_EQ(turns[0].pan, 0.5);
  EXPECT_EQ(turns[0].tilt, -0.25);
  EXPECT_TRUE(script->Update(At(3, {})).cameras.empty());
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

TEST(ScriptTest, RefusesMotionsThatTheDriveCannotExecute) {
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

// A robot with one gripper "hand" on a lift, and a joint "arm".
class ScriptedGripperTest : public testing::Test {
 protected:
  ScriptedGripperTest() {
    robot_ = MakeRobot("script", "{}");
    for (std::size_t i = 0; i < 4; ++i) {
      joints_[i].name = std::array{"hand", "hand.left", "hand.right", "arm"}[i];
      joints_[i].position = {-1.0, 1.0};
      info_.joints.push_back(&joints_[i]);
    }
    hands_[0].name = "hand";
    hands_[1].name = "other";
    info_.robot = &robot_;
    info_.grippers = {{&hands_[0], 1, 2, 0}};
  }
  Result<std::unique_ptr<Controller>> Make(const std::string& commands, const std::string& rest = "") {
    info_.parameters = R"({"commands": [)" + commands + "]" + rest + "}";
    return CreateController(info_);
  }
  std::string ErrorOf(const std::string& command) {
    const auto controller = Make(R"({"at": 0}, {"at": 1, )" + command + "}");
    return controller.ok() ? "" : controller.error().message;
  }
  // "close 0" or "lift 0 to 50" or "joint 3 to 0.5", for each command.
  static std::string CommandsAt(Controller& controller, Tick tick) {
    const Command command = controller.Update(At(tick, {}));
    std::string text;
    const auto add = [&](const std::string& told) { text += (text.empty() ? "" : ", ") + told; };
    for (const GripperCommand& gripper : command.grippers) {
      const std::string number = std::to_string(gripper.gripper);
      if (gripper.fingers) add((*gripper.fingers == FingerCommand::kClose ? "close " : "open ") + number);
      if (gripper.lift) add("lift " + number + " to " + std::to_string(std::lround(*gripper.lift)));
    }
    for (const JointCommand& joint : command.joints) {
      add("joint " + std::to_string(joint.joint) + " to " + std::to_string(std::lround(100 * *joint.position)) +
          "/100");
    }
    return text;
  }

  RobotDescription robot_;
  std::array<JointDescription, 4> joints_;
  std::array<GripperDescription, 2> hands_;
  RobotInfo info_;
};

TEST_F(ScriptedGripperTest, TellsEachThingOnceAndKeepsMotionApart) {
  auto script = Make(R"({"at": 0.2, "gripper": "close", "vx": 1}, {"at": 0.4, "lift": "up"},
                        {"at": 0.5, "lift": 30, "gripper": "open", "joints": {"arm": -0.25}})");
  ASSERT_TRUE(script.ok()) << script.error().message;
  EXPECT_EQ(CommandsAt(*script.value(), 0), "");
  EXPECT_EQ(CommandsAt(*script.value(), 2), "close 0");
  EXPECT_EQ(CommandsAt(*script.value(), 3), "");
  EXPECT_EQ(SpeedAt(*script.value(), 3), 1.0);  // motion holds
  EXPECT_EQ(CommandsAt(*script.value(), 4), "lift 0 to 100");
  EXPECT_EQ(SpeedAt(*script.value(), 4), 0.0);  // a motion without a value is 0
  EXPECT_EQ(CommandsAt(*script.value(), 5), "open 0, lift 0 to 30, joint 3 to -25/100");
  EXPECT_EQ(CommandsAt(*script.value(), 600), "");
}

TEST_F(ScriptedGripperTest, ALateStartGivesTheCommandsOfItsPast) {
  auto script = Make(R"({"at": 0.2, "gripper": "close"}, {"at": 0.4, "lift": "down"}, {"at": 9, "gripper": "open"})");
  EXPECT_EQ(CommandsAt(*script.value(), 50), "close 0, lift 0 to 0");
  EXPECT_EQ(CommandsAt(*script.value(), 51), "");
}

TEST_F(ScriptedGripperTest, RepeatsWithTheScript) {
  auto script =
      Make(R"({"at": 0, "gripper": "close"}, {"at": 0.3, "gripper": "open"}, {"at": 0.5})", R"(, "repeat": true)");
  for (Tick round : {0, 5, 10}) {
    EXPECT_EQ(CommandsAt(*script.value(), round), "close 0");
    EXPECT_EQ(CommandsAt(*script.value(), round + 3), "open 0");
    EXPECT_EQ(CommandsAt(*script.value(), round + 4), "");
  }
  auto late = Make(R"({"at": 0, "gripper": "close"}, {"at": 0.3, "lift": 10})", R"(, "repeat": true, "period": 1)");
  EXPECT_EQ(CommandsAt(*late.value(), 51), "lift 0 to 10, close 0");  // of the round before, and of this one
}

TEST_F(ScriptedGripperTest, NamesSeveralGrippers) {
  info_.grippers.push_back({&hands_[1], 1, 2, {}});
  auto script = Make(R"({"at": 0, "grippers": {"other": {"gripper": "open"}, "hand": {"lift": 5}}})");
  ASSERT_TRUE(script.ok()) << script.error().message;
  EXPECT_EQ(CommandsAt(*script.value(), 0), "lift 0 to 5, open 1");
  EXPECT_EQ(ErrorOf(R"("gripper": "open")"),
            "script: command 2: the robot has 2 grippers, expected 'grippers' with one of: hand, other");
  EXPECT_EQ(ErrorOf(R"("grippers": {"foot": {"lift": 1}})"),
            "script: command 2: unknown gripper 'foot', expected one of: hand, other");
  EXPECT_EQ(ErrorOf(R"("grippers": {"other": {"lift": 1}})"), "script: command 2: gripper 'other' has no lift");
}

TEST_F(ScriptedGripperTest, RefusesPartsThatTheRobotDoesNotHave) {
  EXPECT_EQ(ErrorOf(R"("joints": {"leg": 1})"),
            "script: command 2: unknown joint 'leg', expected one of: hand, hand.left, hand.right, arm");
  EXPECT_EQ(ErrorOf(R"("joints": {"arm": 1.5})"), "script: command 2: joint 'arm' is to go to 1.5, expected -1 to 1");
  EXPECT_EQ(ErrorOf(R"("joints": {"hand.left": 0})"),
            "script: command 2: joint 'hand.left' is a finger, expected 'gripper': \"open\" or \"close\"");
  EXPECT_EQ(ErrorOf(R"("joints": {"hand": 0.5})"), "");  // a lift, by its position
  info_.grippers.clear();
  EXPECT_EQ(ErrorOf(R"("gripper": "open")"), "script: command 2: the robot has no gripper");
}

}  // namespace
}  // namespace troupe
