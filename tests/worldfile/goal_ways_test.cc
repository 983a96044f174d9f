// Robots that search their ways: around walls and furniture, under tables, around boxes, past each other; and reasons
// for ways that do not exist.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "common/model/states.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "robot-agent/controller/create_controller.h"
#include "robot-agent/robot/robot.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "tests/worldfile/scenario_run.h"
#include "world-service/core/step.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

using test::ValueOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A hall of 12 m x 8 m in two halves, with doorways of 1.2 m at the upper and the lower end of the wall between them.
constexpr const char* kHall = R"(
define wall model ( size [1 1 1] color "gray30" gripper_return 0 )
define rover position ( size [0.5 0.4 0.3] drive "diff" localization "gps" )
define box model ( size [0.4 0.4 0.4] gripper_return 1 obstacle_return 1 )
wall ( size [12.4 0.2 1] pose [0 4.1 0 0] )
wall ( size [12.4 0.2 1] pose [0 -4.1 0 0] )
wall ( size [0.2 8.4 1] pose [6.1 0 0 0] )
wall ( size [0.2 8.4 1] pose [-6.1 0 0 0] )
wall ( name "middle" size [0.2 4.4 1] pose [0 0 0 0] )
wall ( size [0.2 0.6 1] pose [0 3.7 0 0] )
wall ( size [0.2 0.6 1] pose [0 -3.7 0 0] )
)";

std::string Rover(const std::string& name, const std::string& pose, const std::string& waypoints,
                  const std::string& controller = "go_to") {
  return "rover ( name \"" + name + "\" pose [" + pose + "] ctrl \"" + controller +
         " plan=true waypoints=" + waypoints + "\" )\n";
}

class GoalWays : public ::testing::Test {
 protected:
  WorldDescription Load(const std::string& text) {
    return ValueOf(LoadWorld(folder_.Write("hall.world", kHall + text))).world;
  }
  std::vector<std::string> Said(const ScenarioRun& run) {
    std::vector<std::string> said;
    for (const Event& event : run.events()) {
      if (event.type == EventType::kSaid) said.push_back(event.detail);
    }
    return said;
  }
  static double DistanceTo(const ScenarioRun& run, const std::string& name, const Vec2& point) {
    return (run[name].X_WR.translation() - point).norm();
  }

  test::TemporaryFolder folder_;
};

TEST_F(GoalWays, LeadAroundAWall) {
  ScenarioRun run(Load(Rover("r", "-3 0 0 0", "[[3,0]]")));
  run.Run(400);
  EXPECT_LT(DistanceTo(run, "r", {3.0, 0.0}), 0.1);
  EXPECT_FALSE(run.EverStalled("r"));
}

TEST_F(GoalWays, OfAllDrives) {
  for (const char* drive : {"omni", "car"}) {
    const std::string rover = std::string("rover ( drive \"") + drive +
                              "\" wheelbase 0.3 name \"r\" pose [-3 0 0 90] ctrl \"go_to plan=true tolerance=0.3 "
                              "waypoints=[[3,0]]\" )\n";
    ScenarioRun run(Load(rover));
    run.Run(900);
    EXPECT_LT(DistanceTo(run, "r", {3.0, 0.0}), 0.5) << drive;
  }
}

TEST_F(GoalWays, LeadUnderATableThatIsHighEnough) {
  const std::string table = "wall ( size [0.2 9 0.2] pose [-2 0 0.4 0] )\n";  // across the hall, above the rover
  const std::string low = "wall ( size [0.2 9 0.2] pose [-2 0 0.2 0] )\n";
  ScenarioRun under(Load(table + Rover("r", "-3 0 0 0", "[[-1,0]]")));
  under.Run(150);
  EXPECT_LT(DistanceTo(under, "r", {-1.0, 0.0}), 0.1);
  ScenarioRun before(Load(low + Rover("r", "-3 0 0 0", "[[-1,0]]")));
  before.Run(150);
  EXPECT_THAT(Said(before), ElementsAre("leaves out the waypoint (-1.00, 0.00): no way leads there"));
  EXPECT_FALSE(before.EverStalled("r"));
}

TEST_F(GoalWays, LeadAroundABoxInTheDoorway) {
  // The lower doorway is nearer, and a box blocks it.
  ScenarioRun run(Load("box ( name \"crate\" pose [0 -2.8 0 0] )\nbox ( pose [0 -2.3 0 0] )\n" +
                       Rover("r", "-3 -2 0 0", "[[3,-2]]")));
  run.Run(700);
  EXPECT_LT(DistanceTo(run, "r", {3.0, -2.0}), 0.1);
  EXPECT_FALSE(run.EverStalled("r"));
  EXPECT_THAT(Said(run), IsEmpty());
}

TEST_F(GoalWays, EndWithAReasonBeforeABoxThatLeavesNoWay) {
  ScenarioRun run(
      Load("box ( name \"low\" pose [0 -2.8 0 0] )\nbox ( pose [0 -2.3 0 0] )\n"
           "box ( name \"high\" pose [0 2.8 0 0] )\nbox ( pose [0 2.3 0 0] )\n" +
           Rover("r", "-3 -2 0 0", "[[3,-2],[-3,2]]")));
  run.Run(900);
  EXPECT_THAT(Said(run), ElementsAre(HasSubstr("leaves out the waypoint (3.00, -2.00): ")));
  EXPECT_THAT(Said(run)[0], HasSubstr("is in the way"));
  EXPECT_LT(DistanceTo(run, "r", {-3.0, 2.0}), 0.1) << "it drives on to the next one";
  EXPECT_FALSE(run.EverStalled("r"));
}

TEST_F(GoalWays, WaitBesideAGoalAtWhichSomethingStands) {
  ScenarioRun run(Load("box ( name \"crate\" pose [3 0 0 0] )\n" + Rover("r", "-3 0 0 0", "[[3,0]]")));
  run.Run(1000);
  EXPECT_LT(DistanceTo(run, "r", {3.0, 0.0}), 1.2);
  EXPECT_THAT(Said(run), ElementsAre(HasSubstr("leaves out the waypoint (3.00, 0.00)")));
  EXPECT_FALSE(run.EverStalled("r"));
}

TEST_F(GoalWays, OfRobotsFaceToFacePassEachOther) {
  // Three against three in the open, with equal lines.
  std::string robots;
  for (int i = 0; i < 3; ++i) {
    const std::string y = std::to_string(i - 1);
    robots += Rover("a" + std::to_string(i), "-5 " + y + " 0 0", "[[-1," + y + "],[-5," + y + "]]", "patrol");
    robots += Rover("b" + std::to_string(i), "-1 " + y + " 0 180", "[[-5," + y + "],[-1," + y + "]]", "patrol");
  }
  ScenarioRun run(Load(robots));
  run.Run(3000);
  EXPECT_THAT(Said(run), IsEmpty());
  const auto stalls = std::count_if(run.events().begin(), run.events().end(),
                                    [](const Event& event) { return event.type == EventType::kStallBegan; });
  EXPECT_LT(stalls, 80) << "six robots in 8 square metres, 30 minutes together";
}

TEST_F(GoalWays, OneOfTwoMakesRoomWhereTheyCannotPass) {
  // A corridor of 0.8 m between two rooms.
  const std::string corridor =
      "wall ( size [4 1.8 1] pose [-3 1.3 0 0] )\nwall ( size [4 1.8 1] pose [-3 -1.3 0 0] )\n"
      "wall ( size [0.2 1 1] pose [0 2.7 0 0] )\nwall ( size [0.2 1 1] pose [0 -2.7 0 0] )\n"
      "wall ( size [4 2 1] pose [-3 3.1 0 0] )\nwall ( size [4 2 1] pose [-3 -3.1 0 0] )\n";
  ScenarioRun run(
      Load(corridor + Rover("a", "-5.5 0 0 0", "[[-0.5,1.5]]") + Rover("b", "-0.5 0 0 180", "[[-5.5,1.5]]")));
  run.Run(1200);
  EXPECT_LT(DistanceTo(run, "a", {-0.5, 1.5}), 0.15);
  EXPECT_LT(DistanceTo(run, "b", {-5.5, 1.5}), 0.15);
}

TEST_F(GoalWays, LeadThroughDoorsThatTheRobotOpens) {
  for (const char* kind : {"sliding", "hinged", "double_hinged"}) {
    SCOPED_TRACE(kind);
    const std::string doors = std::string("door ( name \"gate\" pose [0 -2.8 0 90] size [1.2 0.04 1] kind \"") + kind +
                              "\" )\nwall ( size [0.2 1.2 1] pose [0 2.8 0 0] )\n";
    ScenarioRun run(Load(doors + Rover("r", "-3 -2 0 0", "[[3,-2],[-3,-2]]")));
    run.Run(300);
    EXPECT_EQ(run.state().doors[0].opening, 1.0);
    run.Run(500);
    EXPECT_LT(DistanceTo(run, "r", {-3.0, -2.0}), 0.1) << "there and back";
    EXPECT_FALSE(run.EverStalled("r"));
    EXPECT_THAT(Said(run), IsEmpty());
  }
}

TEST_F(GoalWays, AreCheckedBeforeAGoalIsAccepted) {
  const WorldDescription world = Load(
      "wall ( size [2 2 1] pose [3 0 0 0] )\n"
      "wall ( size [1 0.2 1] pose [5.5 3 0 0] )\nwall ( size [0.2 1.2 1] pose [5 3.5 0 0] )\n"
      "rover ( name \"r\" pose [-3 0 0 0] ctrl \"go_to\" )\n");
  const Scene scene(world);
  const Pose start = world.model(world.robots[0].root).X_PM;
  const auto check = [&](const std::vector<Vec2>& points) {
    const Status status = CheckGoalOfController(scene, RobotId(0), start, {.number = 1, .waypoints = points});
    return status.ok() ? "" : status.error().message;
  };
  EXPECT_EQ(check({{1.0, 0.0}, {5.0, 0.0}}), "");
  EXPECT_EQ(check({{1.0, 0.0}, {3.0, 0.2}}), "there is no room for it at (3.00, 0.20)");
  EXPECT_EQ(check({{5.55, 3.55}}), "no way leads to (5.55, 3.55)");
  EXPECT_EQ(check({{20.0, 0.0}}), "no way leads to (20.00, 0.00)");
}

// A goal of a user, without a parameter: the robot says how it ends.
TEST_F(GoalWays, OfGoalsOfUsersAreSearched) {
  const Scene scene(
      Load("box ( name \"crate\" pose [3 0 0 0] )\nrover ( name \"r\" pose [-3 0 0 0] ctrl \"go_to\" )\n"));
  const std::unique_ptr<Robot> robot = ValueOf(Robot::Create(scene, RobotId(0)));
  BodyIndex bodies(scene);
  WorldState state = InitialState(scene);
  std::vector<std::string> said;
  const auto drive = [&](std::uint32_t number, const Vec2& to, int ticks) {
    ExternalCommand command;
    command.goal = Goal{.number = number, .waypoints = {to}};
    for (int i = 0; i < ticks; ++i) {
      bodies.Assign(state);
      const Proposal proposal = robot->Decide(state, bodies, command);
      StepResult step = Step(scene, state, std::span(&proposal, 1));
      for (const Event& event : step.events) {
        if (event.type == EventType::kSaid) said.push_back(event.detail);
      }
      state = std::move(step.state);
    }
  };
  drive(1, {3.0, 2.0}, 500);
  EXPECT_THAT(said, ElementsAre("reached the goal (3.00, 2.00)"));
  said.clear();
  drive(2, {3.0, 0.0}, 600);
  EXPECT_THAT(said, ElementsAre(HasSubstr("gave up the goal (3.00, 0.00): ")));
  const Pose stands = state.robots[0].X_WR;
  drive(2, {3.0, 0.0}, 100);
  EXPECT_EQ(state.robots[0].X_WR, stands);
  said.clear();
  drive(3, {-3.0, 0.0}, 600);
  EXPECT_THAT(said, ElementsAre("reached the goal (-3.00, 0.00)"));
  // It is moved by an edit behind the wall, and searches its way again.
  said.clear();
  drive(4, {5.0, 2.0}, 50);
  state.robots[0].X_WR = {-5.0, -3.0, 0.0, 0.0};
  drive(4, {5.0, 2.0}, 700);
  EXPECT_THAT(said, ElementsAre("reached the goal (5.00, 2.00)"));
}

// The same bits when it is copied in the middle, and however often its scene is made anew.
TEST_F(GoalWays, ContinueInACopyAndInANewScene) {
  const WorldDescription world = Load(
      "box ( name \"crate\" pose [0 -2.8 0 0] )\nbox ( pose [0 -2.3 0 0] )\nrover ( name \"r\" pose [-3 -2 0 0] ctrl "
      "\"go_to\" )\n");
  const Goal goal{.number = 1, .waypoints = {{3.0, -2.0}}};
  ExternalCommand command;
  command.goal = goal;
  std::vector<std::vector<std::uint64_t>> hashes;
  for (const bool is_disturbed : {false, true}) {
    std::vector<std::unique_ptr<Scene>> scenes;
    scenes.push_back(std::make_unique<Scene>(world));
    std::unique_ptr<Robot> robot = ValueOf(Robot::Create(*scenes.back(), RobotId(0)));
    WorldState state = InitialState(*scenes.back());
    std::vector<std::uint64_t>& run = hashes.emplace_back();
    for (int i = 0; i < 400; ++i) {
      if (is_disturbed && i % 37 == 5) robot = ValueOf(robot->Clone());
      if (is_disturbed && i % 29 == 3) {
        scenes.push_back(std::make_unique<Scene>(world));
        robot->ChangeWorld(*scenes.back());
      }
      BodyIndex bodies(*scenes.back());
      bodies.Assign(state);
      const Proposal proposal = robot->Decide(state, bodies, command);
      state = Step(*scenes.back(), state, std::span(&proposal, 1)).state;
      run.push_back(StateHash(state));
    }
    EXPECT_LT((state.robots[0].X_WR.translation() - Vec2(3.0, -2.0)).norm(), 0.2);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace
}  // namespace troupe
