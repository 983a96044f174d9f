// Robots that follow the lanes of buildings: through doors, with lifts, past each other.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "common/model/states.h"
#include "robot-agent/controller/create_controller.h"
#include "robot-agent/robot/robot.h"
#include "tests/support/values.h"
#include "tests/worldfile/on_lanes.h"
#include "tests/worldfile/scenario_run.h"
#include "tests/worldfile/world_folder.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::ValueOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string LaneSites() {
  return std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites/";
}

// Two rooms of two places each, and a narrow lane between them that one robot at a time may use.
constexpr const char* kNarrow = R"(
name: narrow
coordinate_system: cartesian_meters
levels:
  G:
    elevation: 0
    vertices:
      - [0, 1.5, 0, a, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, alpha]}]
      - [0, -1.5, 0, b]
      - [3, 0, 0, left, {mutex: [1, narrow]}]
      - [9, 0, 0, right, {mutex: [1, narrow]}]
      - [12, 1.5, 0, c]
      - [12, -1.5, 0, d, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, beta]}]
    lanes:
      - [0, 2, {bidirectional: [4, true]}]
      - [1, 2, {bidirectional: [4, true]}]
      - [2, 3, {bidirectional: [4, true], mutex: [1, narrow], speed_limit: [3, 0.3]}]
      - [3, 4, {bidirectional: [4, true]}]
      - [3, 5, {bidirectional: [4, true]}]
)";

// The longest time that each robot stands in a run; and what it reaches.
class StandingWatch {
 public:
  StandingWatch(ScenarioRun& run, std::vector<std::string> robots) : run_(run), robots_(std::move(robots)) {
    standing_.resize(robots_.size(), 0);
    longest_.resize(robots_.size(), 0);
  }
  template <typename Check>
  void Run(int ticks, Check check) {
    for (int i = 0; i < ticks; ++i) {
      run_.Run(1);
      for (std::size_t r = 0; r < robots_.size(); ++r) {
        standing_[r] = run_[robots_[r]].twist.IsZero() ? standing_[r] + 1 : 0;
        longest_[r] = std::max(longest_[r], standing_[r]);
      }
      check();
    }
  }
  int longest(std::size_t robot) const { return longest_[robot]; }  // ticks

 private:
  ScenarioRun& run_;
  std::vector<std::string> robots_;
  std::vector<int> standing_;
  std::vector<int> longest_;
};

bool IsNearPlace(const RobotState& robot, double x, double y, double z = 0.0) {
  return std::hypot(robot.X_WR.x - x, robot.X_WR.y - y) < 0.15 && std::fabs(robot.X_WR.z - z) < 0.01;
}

TEST(Lanes, OneRobotAtATimeIsInAGroupAndNoneWaitsForEver) {
  test::TemporaryFolder folder;
  ScenarioRun run(
      LoadOnLanes(folder, kNarrow,
                  OnLanes("alpha", R"({"places": ["c", "a"]})") + ", " + OnLanes("beta", R"({"places": ["b", "d"]})")));
  StandingWatch watch(run, {"alpha", "beta"});
  int rounds[2] = {0, 0};
  bool was_there[2] = {false, false};
  watch.Run(6000, [&] {
    const auto is_inside = [&](const char* name) {
      const double x = run[name].X_WR.x;
      return x > 3.6 && x < 8.4;
    };
    EXPECT_FALSE(is_inside("alpha") && is_inside("beta")) << run.state().tick;
    for (const char* name : {"alpha", "beta"}) {
      if (is_inside(name)) {
        EXPECT_LT(std::fabs(run[name].twist.vx), 0.301);
      }
    }
    const bool is_there[2] = {IsNearPlace(run["alpha"], 12, 1.5), IsNearPlace(run["beta"], 0, -1.5)};
    for (int i = 0; i < 2; ++i) {
      rounds[i] += is_there[i] && !was_there[i] ? 1 : 0;
      was_there[i] = is_there[i];
    }
  });
  EXPECT_GE(rounds[0], 4);
  EXPECT_GE(rounds[1], 4);
  EXPECT_LT(std::max(watch.longest(0), watch.longest(1)), 600);
  EXPECT_FALSE(run.EverStalled("alpha") || run.EverStalled("beta"));
}

// Without a group they meet in the middle, and one of them makes room.
TEST(Lanes, RobotsThatMeetHeadOnMakeRoom) {
  test::TemporaryFolder folder;
  std::string building = kNarrow;
  for (const std::string mutex : {", {mutex: [1, narrow]}", "mutex: [1, narrow], "}) {
    for (std::size_t at = building.find(mutex); at != std::string::npos; at = building.find(mutex)) {
      building.erase(at, mutex.size());
    }
  }
  ScenarioRun run(
      LoadOnLanes(folder, building,
                  OnLanes("alpha", R"({"places": ["c", "a"]})") + ", " + OnLanes("beta", R"({"places": ["b", "d"]})")));
  int visits[2] = {0, 0};
  StandingWatch watch(run, {"alpha", "beta"});
  watch.Run(6000, [&] {
    visits[0] += IsNearPlace(run["alpha"], 12, 1.5) ? 1 : 0;
    visits[1] += IsNearPlace(run["beta"], 0, -1.5) ? 1 : 0;
  });
  EXPECT_GT(visits[0], 60);
  EXPECT_GT(visits[1], 60);
  EXPECT_LT(std::max(watch.longest(0), watch.longest(1)), 600);
}

TEST(Lanes, OfTheGuesthouseLeadThroughTheDoorAndTheLift) {
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  ScenarioRun run(ValueOf(LoadWorld(LaneSites() + "guesthouse_lanes.json", overrides)).world);
  const std::size_t door = *FindDoor(run.scene().world(), "lobby_door");
  int rooms = 0;  // ticks at the places
  int chargers = 0;
  int corridors = 0;
  int entrances = 0;
  bool was_closed = false;
  StandingWatch watch(run, {"tiny_1", "delivery_1"});
  watch.Run(9000, [&] {
    was_closed = was_closed || run.state().doors[door].opening == 0.0;
    rooms += IsNearPlace(run["tiny_1"], 3, -5.5, 4) ? 1 : 0;
    chargers += IsNearPlace(run["tiny_1"], 1.5, -2) ? 1 : 0;
    corridors += IsNearPlace(run["delivery_1"], 7, -3.75) ? 1 : 0;
    entrances += IsNearPlace(run["delivery_1"], 3, -7) ? 1 : 0;
  });
  EXPECT_GT(rooms, 90);
  EXPECT_GT(chargers, 90);
  EXPECT_GT(corridors, 90);
  EXPECT_GT(entrances, 90);
  for (const int robot : {0, 1}) EXPECT_LT(watch.longest(robot), 1200) << robot;
  EXPECT_TRUE(was_closed);
  // They wait outside of what its leaves sweep, and go round the open ones.
  for (const char* robot : {"tiny_1", "delivery_1"}) EXPECT_FALSE(run.EverStalled(robot)) << robot;
}

TEST(Lanes, BackwardAndDockedAsTheBuildingSays) {
  test::TemporaryFolder folder;
  const std::string building = R"(
coordinate_system: cartesian_meters
levels:
  G:
    vertices:
      - [0, 0, 0, start, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, r]}]
      - [4, 0, 0, middle]
      - [4, 3, 0, bay, {dock_name: [1, bay_dock]}]
      - [8, 0, 0, beyond]
    lanes:
      - [0, 1, {bidirectional: [4, true]}]
      - [1, 2, {bidirectional: [4, true], orientation: [1, backward]}]
      - [3, 1, {}]
)";
  folder.Write("s.building.yaml", building);
  const std::string scenario =
      folder.Write("s.json", R"({"world": "s.building.yaml", "robots": [)" +
                                 OnLanes("r", R"({"places": ["bay", "beyond", "start"], "repeat": false})") + "]}");
  Simulation run = ValueOf(Simulation::Load(scenario));
  const RobotId robot = *run.FindRobot("r");
  std::vector<std::string> reports;
  double fastest_in_bay = 0.0;
  for (int i = 0; i < 900; ++i) {
    run.Step();
    reports.insert(reports.end(), run.reports().begin(), run.reports().end());
    const RobotState& state = run.state().robots[robot.index()];
    if (state.X_WR.y > 0.5 && std::fabs(state.twist.vx) > 0.1) {
      // On both ways it has its back to the bay.
      EXPECT_LT(std::sin(state.X_WR.heading), -0.9) << run.tick();
    }
    if (state.X_WR.y > 2.2) fastest_in_bay = std::max(fastest_in_bay, -state.twist.vx);
  }
  EXPECT_THAT(reports, Contains(HasSubstr("docked at bay_dock")));
  EXPECT_THAT(reports, Contains(HasSubstr("no lanes lead from bay to beyond")));
  EXPECT_GT(fastest_in_bay, 0.05);
  EXPECT_LT(fastest_in_bay, 0.21);
  EXPECT_TRUE(IsNearPlace(run.state().robots[robot.index()], 0, 0));
}

// Lanes without walls, and a station of the scenario.
TEST(Lanes, LeadToTheChargerAtLowEnergy) {
  test::TemporaryFolder folder;
  folder.Write("s.building.yaml", R"(
coordinate_system: cartesian_meters
levels:
  G:
    vertices: [[0, 0, 0, a], [10, 0, 0, b], [5, 0, 0, ""], [5, 1, 0, pad, {is_charger: [4, true]}]]
    lanes: [[0, 2, {bidirectional: true}], [2, 1, {bidirectional: true}], [2, 3, {bidirectional: true}]]
)");
  folder.Write("w.inc", R"(
define cart position( size [0.4 0.4 0.4] drive "diff" kjoules 8 watts 20 mass 8 take_watts 300
  velocity_bounds [-1 1 0 0 0 0 -90 90] acceleration_bounds [-1 1 0 0 0 0 -180 180] )
define station model( size [0.4 0.4 0.4] joules -1 give_watts 300 obstacle_return 0 ))");
  const std::string scenario = folder.Write("s.json", R"({"world": "s.building.yaml", "include": ["w.inc"],
    "robots": [{"name": "r", "model": "cart", "pose": [0, 0, 0, 0],
                "controller": {"name": "lanes", "parameters": {"places": ["b", "a"]}}}],
    "models": [{"name": "station", "model": "station", "pose": [5, 1.3, 0, 0]}]})");
  Simulation run = ValueOf(Simulation::Load(scenario));
  const std::vector<ModelId> stores = FindStores(run.world());
  const auto of_robot = std::find(stores.begin(), stores.end(), run.world().robots[0].root);
  ASSERT_NE(of_robot, stores.end());
  const auto store = static_cast<std::size_t>(of_robot - stores.begin());
  bool was_low = false;
  bool was_charged = false;
  bool has_gone_on = false;
  for (int i = 0; i < 6000; ++i) {
    run.Step();
    const double level = run.state().stores[store].joules / 8000.0;
    EXPECT_GT(level, 0.05) << run.tick();
    was_low = was_low || level < 0.3;
    was_charged = was_charged || (was_low && level > 0.9);
    has_gone_on = has_gone_on || (was_charged && run.state().robots[0].X_WR.x > 9.8);
  }
  EXPECT_TRUE(was_low);
  EXPECT_TRUE(has_gone_on);
}

TEST(Lanes, OfABuildingAreNamedByControllersAndInErrors) {
  test::TemporaryFolder folder;
  folder.Write("s.building.yaml", kNarrow);
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  const auto error = [&](const std::string& parameters) {
    const std::string robots = OnLanes("alpha", parameters);
    return LoadWorld(folder.Write("s.json", R"({"world": "s.building.yaml", "robots": [)" + robots + "]}"), overrides)
        .error()
        .message;
  };
  EXPECT_THAT(error(R"({"places": ["e"]})"),
              HasSubstr("robot 'alpha': lanes: the lanes have no place 'e', expected one of: a, b, left, right, c, d"));
  EXPECT_THAT(error(R"({"graph": 3})"),
              HasSubstr("robot 'alpha': lanes: found no lanes of graph 3, expected one of: 0"));
  overrides.controller = "lanes";
  const LoadedWorld loaded = ValueOf(LoadWorld(folder.Path("s.building.yaml"), overrides));
  EXPECT_EQ(loaded.world.robots[0].controller.parameters, "{}") << "the lanes are in the world, once";
  ASSERT_EQ(loaded.world.lane_graphs.size(), 1u);
  EXPECT_EQ(loaded.world.lane_graphs[0].lanes[2].mutex, "narrow");
  EXPECT_EQ(loaded.world.levels, (std::vector<LevelDescription>{{"G", 0.0}}));
}

// Two levels with places one above the other, and a lift between them.
constexpr const char* kStacked = R"(
coordinate_system: cartesian_meters
levels:
  A:
    vertices: [[7, 3, 0, cabA, {lift_cabin: [1, up]}], [7, 6, 0, doorA],
               [11, 8, 0, eA, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, r1]}], [0, 0, 0, alone], [0, 9, 0, other]]
    lanes: [[0, 1, {bidirectional: true}], [1, 2, {bidirectional: true}], [3, 4, {bidirectional: true}]]
  B:
    elevation: 4
    vertices: [[7, 3, 0, cabB, {lift_cabin: [1, up]}], [7, 6, 0, doorB], [11, 8, 0, eB]]
    lanes: [[0, 1, {bidirectional: true}], [1, 2, {bidirectional: true}]]
lifts:
  up:
    {width: 2, depth: 2, x: 7, y: 3, yaw: 0, initial_floor_name: A,
     doors: {d: {motion_axis_orientation: 0, width: 1.2, x: 0, y: 1}}, level_doors: {A: [d], B: [d]}}
)";

TEST(Lanes, LeadToAGoalOnItsLevelOrAreRefused) {
  test::TemporaryFolder folder;
  const WorldDescription world = LoadOnLanes(folder, kStacked, OnLanes("r1", "{}"));
  const RobotId robot = *FindRobot(world, "r1");
  const Pose& start = world.model(world.robot(robot).root).X_PM;
  Goal goal{.number = 1, .waypoints = {{11.0, 8.0}}, .heights = {4.0}};
  const Scene scene(world);
  EXPECT_TRUE(CheckGoalOfController(scene, robot, start, goal).ok());
  const std::unique_ptr<Robot> r1 = ValueOf(Robot::Create(scene, robot));
  BodyIndex bodies(scene);
  WorldState state = InitialState(scene);
  ExternalCommand command;
  command.goal = goal;
  for (int i = 0; i < 900; ++i) {
    bodies.Assign(state);
    const Proposal proposal = r1->Decide(state, bodies, command);
    state = Step(scene, state, std::span(&proposal, 1)).state;
  }
  EXPECT_TRUE(IsNearPlace(state.robots[robot.index()], 11, 8, 4));
  goal.waypoints = {{0.0, 0.0}};
  goal.heights = {0.0};
  EXPECT_THAT(CheckGoalOfController(scene, robot, start, goal).error().message,
              HasSubstr("no lanes lead from eA to alone"));
  WorldDescription other = world;
  other.robots[robot.index()].controller = {"go_to", "{}"};
  EXPECT_TRUE(CheckGoalOfController(Scene(other), robot, start, goal).ok());
  goal.heights = {4.0};
  EXPECT_THAT(CheckGoalOfController(Scene(other), robot, start, goal).error().message,
              HasSubstr("the goal is at a height of 4.00 m and the robot at 0.00 m, and controller go_to stays"));
  goal.heights = {4.0, 4.0};
  EXPECT_FALSE(CheckRobotCommand(world, {.robot = robot, .goal = goal}).ok());
}

// As `troupe check` does, before a run.
TEST(Scripts, NameThingsOfTheRobotAndItsWorld) {
  test::TemporaryFolder folder;
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  const auto error = [&](const std::string& command) {
    const std::string scenario = R"({"world": ")" + LaneSites() + R"(guesthouse.building.yaml", "robots": [{"name":
      "tiny_1", "controller": {"name": "script", "parameters": {"commands": [{"at": 0, )" +
                                 command + "}]}}}]}";
    const Result<LoadedWorld> loaded = LoadWorld(folder.Write("s.json", scenario), overrides);
    return loaded.ok() ? "" : loaded.error().message;
  };
  EXPECT_EQ(error(R"("lifts": {"guest_lift": "L2"}, "doors": {"lobby_door": "open"})"), "");
  EXPECT_THAT(error(R"("lifts": {"lift": "L2"})"),
              HasSubstr("robot 'tiny_1': script: command 1: unknown lift 'lift', expected"));
  EXPECT_THAT(error(R"("lifts": {"guest_lift": "L3"})"), HasSubstr("unknown floor 'L3' of lift 'guest_lift'"));
  EXPECT_THAT(error(R"("doors": {"door": "open"})"), HasSubstr("unknown door 'door'"));
  // And of its robot.
  EXPECT_THAT(error(R"("gripper": "open")"), HasSubstr("script: command 1: the robot has no gripper"));
  EXPECT_THAT(error(R"("grippers": {"left": {"gripper": "open"}})"),
              HasSubstr("unknown gripper 'left', expected none"));
  EXPECT_THAT(error(R"("joints": {"arm": 0.7})"), HasSubstr("unknown joint 'arm', expected none"));
  EXPECT_THAT(error(R"("lights": {"beacon": true})"), HasSubstr("unknown light 'beacon', expected none"));
  EXPECT_THAT(error(R"("cameras": {"eye": {"pan": 0.5}})"), HasSubstr("unknown camera 'eye', expected none"));
}

// As `troupe ctl spawn TinyRobot --name late` in a run of the building.
TEST(Lanes, AreThoseOfTheWorldForSpawnedRobots) {
  const std::string building = LaneSites() + "guesthouse.building.yaml";
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  const auto scene = std::make_shared<const Scene>(ValueOf(LoadWorld(building, overrides)).world);
  WorldDescription robot = ValueOf(LoadSpawnable({building}, "TinyRobot", overrides)).world;
  ASSERT_EQ(robot.robots.size(), 1u);
  EXPECT_EQ(robot.robots[0].controller.name, "lanes");
  robot.robots[0].controller.parameters = R"({"places": ["corridor"], "repeat": false})";
  const EditedWorld edited =
      ValueOf(SpawnEntity(scene, InitialState(*scene), robot, "late", Pose{3.0, -7.0, 0.0, 0.0}));
  WorldDescription world = edited.scene->world();
  const RobotId late = *FindRobot(world, "late");
  EXPECT_TRUE(CheckControllerNeeds(world, std::array{late}).ok());
  world.robots[late.index()].controller.parameters = R"({"places": ["nowhere"]})";
  EXPECT_FALSE(CheckControllerNeeds(world, std::array{late}).ok());
  ScenarioRun run(edited.scene->world());
  run.Run(900);
  EXPECT_TRUE(IsNearPlace(run["late"], 7, -3.75));
}

// The robots of a world with their controllers, and a user who operates its lifts.
class OperatedRun {
 public:
  explicit OperatedRun(WorldDescription world) : scene_(world), state_(InitialState(scene_)), bodies_(scene_) {
    for (std::size_t i = 0; i < scene_.world().robots.size(); ++i) {
      robots_.push_back(ValueOf(Robot::Create(scene_, RobotId(i))));
    }
  }
  void Run(int ticks, const std::vector<Input>& inputs = {}) {
    for (int i = 0; i < ticks; ++i) {
      bodies_.Assign(state_);
      std::vector<Proposal> proposals;
      for (const std::unique_ptr<Robot>& robot : robots_) proposals.push_back(robot->Decide(state_, bodies_));
      state_ = Step(scene_, state_, proposals, i == 0 ? std::span(inputs) : std::span<const Input>()).state;
    }
  }
  const WorldState& state() const { return state_; }

 private:
  Scene scene_;
  WorldState state_;
  BodyIndex bodies_;
  std::vector<std::unique_ptr<Robot>> robots_;
};

// On its way to the lift, through its doors, in it and out of it: each time a user calls the lift to the other floor.
TEST(Lanes, RobotsCallALiftAgainThatAUserHasCalledAway) {
  test::TemporaryFolder folder;
  const std::string scenario =
      folder.Write("s.json", R"({"world": ")" + LaneSites() + R"(guesthouse.building.yaml", "people": [], "robots": [
        {"name": "tiny_1", "controller": {"name": "lanes", "parameters": {"places": ["room_1"], "repeat": false}}},
        {"name": "delivery_1", "pose": [2, -5, 0], "controller": "idle"}]})");
  const WorldDescription world = ValueOf(LoadWorld(scenario)).world;
  const std::size_t robot = FindRobot(world, "tiny_1")->index();
  for (const int call_at : {200, 250, 270, 280, 284, 288, 292, 296, 300, 310, 330, 400}) {
    OperatedRun run(world);
    run.Run(call_at);
    const bool is_below = run.state().lifts[0].z < 2.0;
    run.Run(900 - call_at, {{{}, LiftOrder{0, is_below ? 1u : 0u}}});
    EXPECT_TRUE(IsNearPlace(run.state().robots[robot], 3, -5.5, 4)) << "called at tick " << call_at;
  }
}

// Two chargers so near to each other that their robots nearly touch.
TEST(Lanes, IdleRobotsBesideEachOtherStayAtTheirChargers) {
  test::TemporaryFolder folder;
  ScenarioRun run(LoadOnLanes(folder, R"(
coordinate_system: cartesian_meters
levels:
  G:
    vertices:
      - [0, 0, 0, a, {is_charger: true, spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, alpha]}]
      - [0.8, 0, 0, b, {is_charger: true, spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, beta]}]
      - [0, 3, 0, left]
      - [0.8, 3, 0, right]
    lanes: [[0, 2, {bidirectional: true}], [1, 3, {bidirectional: true}], [2, 3, {bidirectional: true}]]
)",
                              OnLanes("alpha", "{}") + ", " + OnLanes("beta", "{}")));
  for (int i = 0; i < 600; ++i) {
    run.Run(1);
    ASSERT_TRUE(IsNearPlace(run["alpha"], 0, 0) && IsNearPlace(run["beta"], 0.8, 0)) << i;
  }
}

// An idle robot makes room on the only lane, and comes back.
TEST(Lanes, AnIdleRobotReturnsAfterItHasMadeRoom) {
  test::TemporaryFolder folder;
  ScenarioRun run(LoadOnLanes(folder, R"(
coordinate_system: cartesian_meters
levels:
  G:
    vertices:
      - [0, 0, 0, a, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, alpha]}]
      - [4, 0, 0, m, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, beta]}]
      - [8, 0, 0, c]
      - [4, 2, 0, side]
    lanes: [[0, 1, {bidirectional: true}], [1, 2, {}], [1, 3, {bidirectional: true, graph_idx: 1}]]
)",
                              OnLanes("alpha", R"({"places": ["c"], "repeat": false, "planned": false})") + ", " +
                                  OnLanes("beta", R"({"graph": 1, "planned": false})")));
  bool was_aside = false;
  for (int i = 0; i < 1200; ++i) {
    run.Run(1);
    was_aside = was_aside || IsNearPlace(run["beta"], 4, 2);
  }
  EXPECT_TRUE(was_aside);
  EXPECT_TRUE(IsNearPlace(run["alpha"], 8, 0));
  EXPECT_TRUE(IsNearPlace(run["beta"], 4, 0));
}

// A controller that continues from the middle of a run is the same.
TEST(Lanes, AreFollowedAlikeByCopies) {
  Simulation run = ValueOf(Simulation::Load(LaneSites() + "guesthouse_lanes.json"));
  run.Step(1500);
  const Snapshot middle = ValueOf(run.Save());
  run.Step(1500);
  const std::uint64_t expected = run.state_hash();
  ASSERT_TRUE(run.Restore(middle).ok());
  run.Step(1500);
  EXPECT_EQ(run.state_hash(), expected);
}

// Messages about a lane along x at the given y, through a door of 1 m whose open leaf is on y = -0.5.
std::vector<std::string> MessagesAboutALaneAt(double y, const std::string& robot) {
  const std::string at = std::to_string(y);
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("s.building.yaml", R"(
name: passage
coordinate_system: cartesian_meters
levels:
  G:
    elevation: 0
    vertices:
      - [5, -0.5, 0, ""]
      - [5, 0.5, 0, ""]
      - [2, )" + at + R"(, 0, a)" + robot + R"(]
      - [8, )" + at + R"(, 0, ""]
      - [2, 9, 0, b]
    doors:
      - [0, 1, {name: [1, gate], type: [1, hinged], motion_axis: [1, start]}]
    lanes:
      - [2, 3, {bidirectional: [4, true]}]
      - [2, 4, {bidirectional: [4, true]}]
)");
  std::vector<std::string> messages;
  for (const Warning& warning : ValueOf(LoadWorld(path)).warnings) messages.push_back(warning.message);
  return messages;
}

TEST(NarrowLanes, LanesAtOpenLeavesAreNamed) {
  const std::string tiny = ", {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, tiny]}";
  EXPECT_THAT(MessagesAboutALaneAt(0.0, tiny), IsEmpty());
  EXPECT_THAT(MessagesAboutALaneAt(-0.4, ""), IsEmpty());
  EXPECT_THAT(MessagesAboutALaneAt(-0.4, tiny),
              ElementsAre("lane from 'a' to (8, -0.4) is 0.08 m from the open leaf 'gate.right', expected 0.21 m, half "
                          "the width of the narrowest robot, or more; robots may be stuck there"));
  EXPECT_THAT(MessagesAboutALaneAt(-0.5, ""),
              ElementsAre("lane from 'a' to (8, -0.5) passes through the open leaf 'gate.right', so robots may be "
                          "stuck there"));
}

}  // namespace
}  // namespace troupe
