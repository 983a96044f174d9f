#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/values.h"
#include "tests/unit/robot-agent/controller/controlled_robot.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(CheckControllerTest, BuiltInNamesAreSorted) {
  EXPECT_THAT(BuiltInControllers(),
              ElementsAre("dynamic", "expand", "fasr", "fasr2", "fasr_plan", "fetch", "flock", "follow", "go_to",
                          "idle", "lanes", "lasernoise", "patrol", "pioneer_flocking", "rasterize", "script", "sink",
                          "slotcar", "source", "vda5050", "wander"));
}

struct Case {
  const char* name;
  const char* parameters;
  const char* message;  // "": success
};

class CheckControllerTableTest : public ::testing::TestWithParam<Case> {};

TEST_P(CheckControllerTableTest, AcceptsGoodInputAndNamesTheFault) {
  const Case& c = GetParam();
  EXPECT_EQ(MessageOf(CheckController(c.name, c.parameters)), c.message);
}

INSTANTIATE_TEST_SUITE_P(
    Table, CheckControllerTableTest,
    ::testing::Values(
        Case{"idle", "{}", ""},  //
        Case{"wander", "{}", ""},
        Case{"wander", R"({"speed": 1, "turn_rate": 0.5, "min_distance": 0.7, "front_angle": 0.3, "back_off_time": 0,
                           "steering_angle": 0.4})",
             ""},
        Case{"expand", R"({"speed": 0.2, "turn_gain": 2, "clear_distance": 1, "clear_angle": 0.2})", ""},
        Case{"script", R"({"commands": [{"at": 0, "vx": 0.5, "wz": 0}, {"at": 2.5}]})", ""},
        Case{"script", R"({"commands": [{"at": 0, "speed": 0.5}], "repeat": true, "period": 3})", ""},
        Case{"./my.so", R"({"anything": [1, 2]})", ""},  //
        Case{"my.so", "{}", ""},
        Case{
            "fly", "{}",
            "unknown controller 'fly', expected one of: dynamic, expand, fasr, fasr2, fasr_plan, fetch, flock, follow, "
            "go_to, idle, lanes, lasernoise, "
            "patrol, pioneer_flocking, rasterize, script, sink, slotcar, source, vda5050, wander, or the path of a "
            "shared "
            "library (.so)"},
        Case{
            "idle", "",
            "idle: 1:1: not valid JSON: syntax error while parsing value - unexpected end of input; expected '[', '{', "
            "or a literal"},
        Case{"idle", "{",
             "idle: 1:2: not valid JSON: syntax error while parsing object key - unexpected end of input; expected "
             "string literal"},
        Case{"idle", "7", "idle: found the number 7, expected an object"},
        Case{"my.so", "[1]", "controller library my.so: found an array of 1, expected an object"},
        Case{"idle", R"({"speed": 1})", "idle: found the key 'speed', expected none"},
        Case{"idle", R"({"speed": 1, "speed": 2})", "idle: 1:14: found the key 'speed' again, expected it once"},
        Case{"wander", R"({"sped": 1})",
             "wander: found the key 'sped', expected one of back_off_time, clearance, front_angle, min_distance, "
             "speed, steering_angle, turn_rate; did you mean 'speed'?"},
        Case{"wandr", "{}",
             "unknown controller 'wandr', expected one of: dynamic, expand, fasr, fasr2, fasr_plan, fetch, flock, "
             "follow, "
             "go_to, idle, lanes, lasernoise, "
             "patrol, pioneer_flocking, rasterize, script, sink, slotcar, source, vda5050, wander, or the path of a "
             "shared library (.so); did you mean 'wander'?"},
        Case{"wander", R"({"speed": "fast"})",
             "wander: found the string 'fast' as 'speed', expected a number between 0 and 100"},
        Case{"wander", R"({"speed": -1})",
             "wander: found the number -1 as 'speed', expected a number between 0 and 100"},
        Case{"wander", R"({"speed": 1e999})",
             "wander: 1:11: found a number that is too large, expected at most 1.8e308"},
        Case{"expand", R"({"turn_gain": null})",
             "expand: found null as 'turn_gain', expected a number between 0 and 100"},
        Case{"expand", R"({"clear_angle": [1]})",
             "expand: found an array of 1 as 'clear_angle', expected a number between 0 and 3.141592653589793"},
        Case{"fasr", R"({"charger": [1, 2], "charge_below": 0.2, "charge_to": 0.2})", ""},
        Case{"fasr", R"({"charger": "bay"})",
             "fasr: found the string 'bay' as 'charger', expected a point [x, y] or the id of a fiducial"},
        Case{"fasr2", R"({"charge_below": 30})",
             "fasr2: found the number 30 as 'charge_below', expected a number between 0 and 1"},
        Case{"fasr_plan", R"({"charger": 3, "charge_below": 0.5, "charge_to": 0.4})",
             "fasr_plan: 'charge_to' is 0.4, expected a number from 'charge_below', which is 0.5, to 1"},
        Case{"script", "{}", "script: found no 'commands', expected a list of {\"at\": seconds, ...}"},
        Case{"script", R"({"commands": {}})", "script: found an empty object as 'commands', expected a list"},
        Case{"script", R"({"commands": [5]})", "script: found the number 5 as 'commands[0]', expected an object"},
        Case{"script", R"({"commands": [{"vx": 1}]})",
             "script: found no 'at' in 'commands[0]', expected a time in seconds"},
        Case{"script", R"({"commands": [{"at": -1}]})",
             "script: found the number -1 as 'commands[0].at', expected a number of at least 0"},
        Case{"script", R"({"commands": [{"at": 1}, {"at": 1}]})",
             "script: found the number 1 as 'commands[1].at', expected a time after that of the command before it, 1"},
        Case{"script", R"({"commands": [{"at": 0, "vz": 1}]})",
             "script: found the key 'vz' in 'commands[0]', expected one of at, cameras, doors, gripper, "
             "grippers, joints, lift, lifts, lights, say, send, speed, steering, vx, vy, wz"},
        Case{"script", R"({"commands": [{"at": 0, "gripper": "ajar"}]})",
             "script: found the string 'ajar' as 'commands[0].gripper', expected \"open\" or \"close\""},
        Case{"script", R"({"commands": [{"at": 0, "lift": 140}]})",
             "script: found the number 140 as 'commands[0].lift', expected a number between 0 and 100 or \"up\" or "
             "\"down\""},
        Case{"script", R"({"commands": [{"at": 0, "grippers": {"left hand": {"lift": -1}}}]})",
             "script: found the number -1 as 'commands[0].grippers.left hand.lift', expected a number between 0 and "
             "100 or \"up\" or "
             "\"down\""},
        Case{"script", R"({"commands": [{"at": 0, "grippers": {"a": {}}}]})",
             "script: found an empty object as 'commands[0].grippers.a', expected a name, with 'gripper' or 'lift'"},
        Case{"script", R"({"commands": [{"at": 0, "grippers": {"a": {"lift": 1, "close": 1}}}]})",
             "script: found the key 'close' in 'commands[0].grippers.a', expected one of gripper, lift"},
        Case{"script", R"({"commands": [{"at": 0, "grippers": 7}]})",
             "script: found the number 7 as 'commands[0].grippers', expected an object"},
        Case{"script", R"({"commands": [{"at": 0, "lift": 1, "grippers": {"a": {"lift": 1}}}]})",
             "script: found an object as 'commands[0]', expected either 'grippers' or, for a robot's only gripper, "
             "'gripper' or 'lift'"},
        Case{"script", R"({"commands": [{"at": 0, "joints": {"arm": "up"}}]})",
             "script: found the string 'up' as 'commands[0].joints.arm', expected a number"},
        Case{"script", R"({"commands": [{"at": 0}, {"at": 1, "gripper": "open"}], "repeat": true})",
             "script: the last command only marks the end and is never done, expected none for grippers, joints, "
             "radios, lights, cameras, doors, lifts or texts in it"},
        Case{"script", R"({"commands": [{"at": 0, "lights": {"lamp": 1}}]})",
             "script: found the number 1 as 'commands[0].lights.lamp', expected true or false"},
        Case{
            "script", R"({"commands": [{"at": 0, "vx": 1, "steering": 0}]})",
            "script: found an object as 'commands[0]', expected either a twist (vx, vy, wz) or a car's command (speed, "
            "steering)"},
        Case{"script", R"({"commands": [{"at": 0}], "repeat": 1})",
             "script: found the number 1 as 'repeat', expected true or false"},
        Case{"script", R"({"commands": [{"at": 0}], "period": 1})",
             "script: found 'period' without 'repeat', expected both, or none"},
        Case{"script", R"({"commands": [{"at": 2}], "repeat": true, "period": 1})",
             "script: found 1 as 'period', expected at least 2, the time of the last command"},
        Case{"script", R"({"commands": [{"at": 0}], "repeat": true})",
             "script: nothing to repeat: the last command is at 0 and there is no 'period', expected one of them above "
             "0"}));

TEST(CheckControllerTest, ValuesInMessagesAreShortAndOnOneLine) {
  const std::string message =
      MessageOf(CheckController("wander", "{\"speed\": \"" + std::string(1000, 'x') + "\\n\"}"));
  EXPECT_LT(message.size(), 120u);
  EXPECT_THAT(message, HasSubstr("..."));
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(CheckControllerTest, DeepNestingIsNoTrouble) {
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  EXPECT_EQ(MessageOf(CheckController("wander", "{\"speed\": " + deep + "}")),
            "wander: 1:74: found deeper nesting, expected at most 64 objects and arrays inside each other");
}

TEST(CheckControllerTest, CreatingReportsTheSameError) {
  const RobotDescription robot = MakeRobot("wander", R"({"speed": -1})");
  const Result<std::unique_ptr<Controller>> controller = CreateFor(robot);
  ASSERT_FALSE(controller.ok());
  EXPECT_EQ(controller.error().message, "wander: found the number -1 as 'speed', expected a number between 0 and 100");
}

TEST(IdleTest, StandsStill) {
  const RobotDescription robot = MakeRobot("idle", "{}");
  const Result<std::unique_ptr<Controller>> controller = CreateFor(robot);
  ASSERT_TRUE(controller.ok());
  EXPECT_TRUE(controller.value()->Subscriptions().empty());
  EXPECT_TRUE(controller.value()->Update(At(0, {})).twist.IsZero());
}

using ::testing::EndsWith;
using ::testing::StartsWith;

// Where the build puts the libraries of library_variants.cc.
std::string LibraryFolder() {
  return std::string(TEST_LIBRARY_FOLDER);
}

std::string Library(const std::string& variant) {
  return std::filesystem::path(LibraryFolder()) / ("libcontroller_" + variant + ".so");
}

std::string ErrorOf(const std::string& path, const std::string& parameters = "{}") {
  const RobotDescription robot = MakeRobot(path, parameters);
  const Result<std::unique_ptr<Controller>> controller = CreateFor(robot);
  return controller.ok() ? "" : controller.error().message;
}

TEST(LibraryControllerTest, RunsAUsersController) {
  const RobotDescription robot = MakeRobot(Library("good"), "{}");
  EXPECT_EQ(test::ValueOf(CreateFor(robot))->Update(At(0, {})).twist.vx, 0.25);
}

TEST(LibraryControllerTest, ARelativePathCountsFromTheWorkingDirectory) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(LibraryFolder());
  EXPECT_EQ(ErrorOf("libcontroller_good.so"), "");
  EXPECT_EQ(ErrorOf("./libcontroller_good.so"), "");
  EXPECT_THAT(ErrorOf("missing.so"), HasSubstr("no such file: " + LibraryFolder() + "/missing.so"));
  std::filesystem::current_path(before);
}

TEST(LibraryControllerTest, EachFaultHasItsMessage) {
  EXPECT_THAT(ErrorOf("/nowhere/my.so"), StartsWith("controller library /nowhere/my.so: no such file"));
  EXPECT_THAT(ErrorOf(Library("not_one")), HasSubstr("is not a controller"));
  EXPECT_THAT(ErrorOf(Library("wrong_version")),
              HasSubstr("found interface version " + std::to_string(TROUPE_CONTROLLER_ABI + 41) + ", expected " +
                        std::to_string(TROUPE_CONTROLLER_ABI)));
  EXPECT_THAT(ErrorOf(Library("makes_nothing")), EndsWith("made no controller"));
  EXPECT_THAT(ErrorOf(Library("throws_at_start"), R"({"a":1})"), EndsWith("parameters {\"a\":1} are not to my taste"));
}

TEST(LibraryControllerTest, AFileThatIsNoLibraryCannotBeOpened) {
  const std::string path = ::testing::TempDir() + "/troupe_no_library.so";
  std::ofstream(path) << "nonsense";
  EXPECT_THAT(ErrorOf(path), HasSubstr("cannot be opened"));
  std::filesystem::remove(path);
}

TEST(Parameters, AreReadByKey) {
  Parameters parameters("p", R"({"speed": 0.4, "loud": true, "wall": "left", "turn": "right"})");
  EXPECT_EQ(parameters.ReadNumber("speed", {0.0, 1.0}), 0.4);
  EXPECT_EQ(parameters.ReadNumber("distance", {0.0, 1.0}), std::nullopt);
  EXPECT_EQ(parameters.ReadBool("loud"), true);
  EXPECT_EQ(parameters.ReadText("wall"), "left");
  EXPECT_EQ(parameters.ReadNumberOrName("turn", {-1.0, 1.0}, {{"left", 1.0}, {"right", -1.0}}), -1.0);
  EXPECT_EQ(MessageOf(parameters.Finish()), "");
}

TEST(Parameters, OfTheWrongKindAreErrorsAndHaveNoValue) {
  Parameters number("p", R"({"x": 2})");
  EXPECT_EQ(number.ReadNumber("x", {0.0, 1.0}), std::nullopt);
  EXPECT_EQ(MessageOf(number.status()), "p: found the number 2 as 'x', expected a number between 0 and 1");
  Parameters flag("p", R"({"x": 1})");
  EXPECT_EQ(flag.ReadBool("x"), std::nullopt);
  EXPECT_EQ(MessageOf(flag.status()), "p: found the number 1 as 'x', expected true or false");
  Parameters text("p", R"({"x": {}})");
  EXPECT_EQ(text.ReadText("x"), std::nullopt);
  EXPECT_EQ(MessageOf(text.status()), "p: found an empty object as 'x', expected a text");
}

TEST(Parameters, KeepTheFirstErrorAndNameUnknownKeys) {
  Parameters first("p", "[]");
  first.Fail("another");
  EXPECT_EQ(MessageOf(first.Finish()), "p: found an empty array, expected an object");
  Parameters unknown("p", R"({"sped": 1})");
  EXPECT_EQ(unknown.ReadNumber("speed", {0.0, 1.0}), std::nullopt);
  EXPECT_EQ(MessageOf(unknown.status()), "");
  EXPECT_EQ(MessageOf(unknown.Finish()), "p: found the key 'sped', expected one of speed; did you mean 'speed'?");
}

}  // namespace
}  // namespace troupe
