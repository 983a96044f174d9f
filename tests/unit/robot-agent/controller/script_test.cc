#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/values.h"
#include "tests/unit/robot-agent/controller/controlled_robot.h"

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
  EXPECT_TRUE(script->Update(At(1, {})).orders.empty());
  EXPECT_EQ(script->Update(At(2, {})).orders, (std::vector<Order>{CameraOrder{1, 0.5, -0.25}}));
  EXPECT_TRUE(script->Update(At(3, {})).orders.empty());
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
    const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
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
  EXPECT_EQ(CommandsAt(*script.value(), 0), "open 1, lift 0 to 5");
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

struct FetchCase {
  const char* parameters;
  const char* message;
};

TEST(FetchParameters, AreCheckedStepByStep) {
  const FetchCase cases[] = {
      {R"({"steps": [{"go_to": [1, 2]}, {"turn_to": 1}, {"drive": -1}, {"push": 1}, {"gripper": "open"}, {"lift": 50},
                     {"wait": 1}, {"wait_until": 9}, {"take": [1, 2, 3, 0]}, {"put": "shelf"}],
           "places": [{"name": "shelf", "at": [0, 0, 0, 100]}],
           "speed": 1, "turn_rate": 1, "reach": 0.5, "approach": 1, "raise": 3, "travel": 10})",
       ""},
      {"{}", "fetch: found no 'steps', expected a list of steps"},
      {R"({"steps": [5]})", "fetch: found the number 5 as 'steps[0]', expected an object"},
      {R"({"steps": [{"wait": 1}, {"wait": 1, "lift": 2}]})",
       "fetch: found an object as 'steps[1]', expected an object with one key"},
      {R"({"steps": [{"jump": 1}]})",
       "fetch: found the key 'jump', expected one of drive, go_to, gripper, lift, push, put, take, turn_to, wait, "
       "wait_until"},
      {R"({"steps": [{"lift": 140}]})",
       "fetch: found the number 140 as 'steps[0].lift', expected a number between 0 and 100"},
      {R"({"steps": [{"lift": "up"}]})",
       "fetch: found the string 'up' as 'steps[0].lift', expected a number between 0 and 100"},
      {R"({"steps": [{"wait": -1}]})",
       "fetch: found the number -1 as 'steps[0].wait', expected a number between 0 and 1000000000"},
      {R"({"steps": [{"go_to": [1]}]})",
       "fetch: found an array of 1 as 'steps[0].go_to', expected a list of 2 numbers from -1e+06 to 1e+06"},
      {R"({"steps": [{"go_to": [1, 1e7]}]})",
       "fetch: found an array of 2 as 'steps[0].go_to', expected a list of 2 numbers from -1e+06 to 1e+06"},
      {R"({"steps": [{"gripper": "shut"}]})",
       "fetch: found the string 'shut' as 'steps[0].gripper', expected \"open\" or \"close\""},
      {R"({"steps": [{"take": "shelf"}]})",
       "fetch: found the string 'shelf' as 'steps[0].take', expected the name of one of 'places'"},
      {R"({"steps": [{"put": [1, 2, 3]}]})",
       "fetch: found an array of 3 as 'steps[0].put', expected a list of 4 numbers from -1e+06 to 1e+06"},
      {R"({"steps": [{"put": [1, 2, 3, 101]}]})",
       "fetch: found an array of 4 as 'steps[0].put', expected [x, y, heading, lift] with a lift of 0 to 100 percent"},
      {R"({"steps": [{"wait": 1}], "places": [{"name": "a"}]})",
       "fetch: found no 'at' in 'places[0]', expected [x, y, heading, lift] with a lift of 0 to 100 percent"},
      {R"({"steps": [{"wait": 1}], "reach": -1})",
       "fetch: found the number -1 as 'reach', expected a number of at least 0"},
      {R"({"steps": [{"wait": 1}], "rech": 1})",
       "fetch: found the key 'rech', expected one of approach, places, raise, reach, repeat, speed, steps, travel, "
       "turn_rate; did you mean 'reach'?"},
  };
  for (const FetchCase& c : cases)
    EXPECT_EQ(MessageOf(CheckController("fetch", c.parameters)), c.message) << c.parameters;
}

TEST(FetchWithoutGripper, IsAnErrorIfItNeedsOne) {
  const auto message_of = [](const std::string& step, DriveType drive = DriveType::kDifferential) {
    const RobotDescription robot = MakeRobot("fetch", R"({"steps": [)" + step + "]}", {}, drive);
    const auto controller = CreateFor(robot);
    return controller.ok() ? "" : controller.error().message;
  };
  const std::string message =
      "fetch: the robot has no gripper, expected one for the steps 'gripper', 'lift', 'take' and 'put'";
  EXPECT_EQ(message_of(R"({"gripper": "open"})"), message);
  EXPECT_EQ(message_of(R"({"lift": 5})"), message);
  EXPECT_EQ(message_of(R"({"take": [0, 0, 0, 0]})"), message);
  EXPECT_EQ(message_of(R"({"go_to": [1, 1]})"), "");
  EXPECT_EQ(message_of(R"({"drive": 1})", DriveType::kCar),
            "fetch: the robot is a car, expected one that turns on the spot");
}

// Drives a robot without inertia.
class FetchTest : public testing::Test {
 protected:
  void Follow(const std::string& steps, int ticks) {
    robot_ = MakeRobot("fetch", R"({"speed": 0.5, "turn_rate": 1, "steps": [)" + steps + "]}");
    robot_.drive.velocity = {{-1.0, 1.0}, {0.0, 0.0}, {-2.0, 2.0}};
    robot_.drive.acceleration = {{-1.0, 1.0}, {0.0, 0.0}, {-2.0, 2.0}};
    auto controller = CreateFor(robot_);
    ASSERT_TRUE(controller.ok()) << controller.error().message;
    for (int tick = 0; tick < ticks; ++tick) {
      Observation observation = At(static_cast<Tick>(tick), {}, stalled_);
      observation.pose_estimate = pose_;
      const Command command = controller.value()->Update(observation);
      EXPECT_LE(std::abs(command.twist.vx), 0.5);
      EXPECT_LE(std::abs(command.twist.wz), 1.0);
      Pose next = pose_ * Integrate(command.twist, observation.interval);
      stalled_ = next.x > wall_;
      if (!stalled_) pose_ = next;
    }
  }

  RobotDescription robot_;
  Pose pose_;
  bool stalled_ = false;
  double wall_ = 100.0;  // m: it gets no further along x
};

TEST_F(FetchTest, ReachesPointsAndHeadingsExactly) {
  Follow(R"({"go_to": [1, 2]}, {"go_to": [-1, 0.5]}, {"turn_to": 3.5})", 300);
  EXPECT_NEAR(pose_.x, -1.0, 1e-5);
  EXPECT_NEAR(pose_.y, 0.5, 1e-5);
  EXPECT_NEAR(pose_.heading, WrapAngle(3.5), 1e-9);
}

TEST_F(FetchTest, DrivesStraightAheadAndBack) {
  Follow(R"({"turn_to": 1.5707963267948966}, {"drive": 2}, {"drive": -0.5})", 300);
  EXPECT_NEAR(pose_.x, 0.0, 1e-9);
  EXPECT_NEAR(pose_.y, 1.5, 1e-5);
}

TEST_F(FetchTest, PushesUntilItIsStopped) {
  wall_ = 0.7;
  Follow(R"({"push": 2}, {"drive": -0.5})", 100);
  EXPECT_NEAR(pose_.x, 0.2, 0.05);
}

TEST_F(FetchTest, Waits) {
  Follow(R"({"wait": 1}, {"wait_until": 2.5}, {"drive": 0.2})", 25);
  EXPECT_EQ(pose_.x, 0.0);
}

}  // namespace
}  // namespace troupe
