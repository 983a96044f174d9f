// No robot stays at a contact that it could leave: built-in controllers in random worlds.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "common/spatial/sweep.h"
#include "tests/support/random_world.h"
#include "tests/support/stage_worlds.h"
#include "troupe/deterministic_math.h"
#include "troupe/simulation.h"

namespace troupe {
namespace {

constexpr int kMinute = 600;  // ticks

struct Kind {
  const char* controller;
  const char* parameters;
  bool may_stand;  // on purpose: at its goal, or without one. It must not stand stalled.
};

constexpr std::array<Kind, 15> kKinds{{
    {"wander", "{}", false},
    {"wander", R"({"min_distance": 0.3, "speed": 0.8})", false},
    {"expand", "{}", false},
    {"patrol", R"({"waypoints": [[2, 2], [-2, -2], [3, -2]]})", false},
    {"go_to", R"({"waypoints": [[1.5, -1.5], [-2, 2]], "heading": 1})", true},
    {"patrol", R"({"plan": true, "waypoints": [[2, -2], [-2, 2], [3, 2]]})", true},  // before a blocked way
    {"go_to", R"({"plan": true, "waypoints": [[1.5, 1.5], [-2, 2]]})", true},
    {"dynamic", "{}", false},
    {"follow", "{}", true},
    {"pioneer_flocking", "{}", false},
    {"flock", R"({"radius": 2})", false},
    {"fasr", R"({"source": [2, 2], "sink": [-2, -2]})", true},
    {"fasr", R"({"source": 3, "sink": [-2, -2], "reach": 0.8})", true},
    {"fasr_plan", R"({"source": [-2, 2], "sink": [2, -2], "map_size": 16})", true},
    {"fetch", R"({"steps": [{"go_to": [2, 1]}, {"turn_to": 2}, {"go_to": [-2, -1]}, {"turn_to": 0}]})", true},
}};

std::string Number(double value) {
  return std::to_string(value);
}

std::string RandomFootprint(test::RandomStream& random) {
  const std::string size =
      " size [" + Number(random.Uniform(0.2, 0.7)) + " " + Number(random.Uniform(0.2, 0.5)) + " 0.3]";
  switch (random.Index(4)) {
    case 0:  // a triangle
      return size + " block( points 3 point[0] [0 0] point[1] [2 1] point[2] [0 2] z [0 1] )";
    case 1:  // an L
      return size +
             " block( points 6 point[0] [0 0] point[1] [3 0] point[2] [3 1] point[3] [1 1] point[4] [1 2] point[5] "
             "[0 2] z [0 1] )";
    case 2:  // its drive is not in its middle
      return size + " origin [0.1 0.05 0 0]";
    default:
      return size;
  }
}

// A closed room with posts and robots, each in a square of its own.
std::string RandomRoom(test::RandomStream& random, double clutter, double crowd) {
  constexpr double kSquare = 1.1;  // m
  const int squares = 3 + static_cast<int>(random.Index(6));
  const double half = 0.5 * kSquare * squares;
  std::string text = "define wall model( )\n";
  const std::string length = Number(2.0 * half + 0.4);
  const std::string edge = Number(half + 0.1);
  for (const char* side : {"", "-"}) {
    text += "wall( size [" + length + " 0.2 1] pose [0 " + side + edge + " 0 0] )\n";
    text += "wall( size [0.2 " + length + " 1] pose [" + side + edge + " 0 0 0] )\n";
  }
  const char* const drives[] = {"diff", "omni", "car"};
  for (int i = 0; i < squares * squares; ++i) {
    const std::string pose = " pose [" + Number(-half + kSquare * (i % squares + 0.5)) + " " +
                             Number(-half + kSquare * (i / squares + 0.5)) + " 0 " +
                             Number(random.Uniform(-180.0, 180.0)) + "]";
    const double draw = random.Uniform(0.0, 1.0);
    if (draw < clutter) {
      text += "wall( size [" + Number(random.Uniform(0.1, 0.7)) + " " + Number(random.Uniform(0.1, 0.7)) + " 1]" +
              pose + " )\n";
    } else if (draw < clutter + crowd) {
      text += std::string("position( drive \"") + drives[random.Index(3)] + "\" wheelbase 0.3" + pose +
              RandomFootprint(random) +
              "\n fiducial_return 3 ranger( sensor( range [0 6] fov 180 samples 19 ) ) fiducial( range_max 4 fov 180 "
              ") radio( range 5 bandwidth 2000 ) )\n";
    }
  }
  return text;
}

Result<WorldDescription> LoadText(const std::string& text, std::uint64_t seed) {
  const std::string path = testing::TempDir() + "recovery_property_test_" + std::to_string(seed) + ".world";
  std::ofstream(path) << text;
  Result<Simulation> loaded = Simulation::Load(path);
  std::filesystem::remove(path);
  if (!loaded.ok()) return loaded.error();
  return loaded.value().world();
}

// The robots of a run that rest for a minute although a motion of their drive is free.
class RestingRobots {
 public:
  explicit RestingRobots(const WorldDescription& world) : scene_(world), index_(scene_), places_(world.robots.size()) {}

  // The names of those whose minute ends at this state.
  std::vector<std::string> Find(const WorldState& state, const std::vector<bool>& may_stand) {
    std::vector<std::string> found;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const RobotState& robot = state.robots[i];
      Place& place = places_[i];
      const bool stands = may_stand[i] && !robot.stalled;
      const bool moved = (robot.X_WR.translation() - place.X_WR.translation()).norm() > 0.01 ||
                         std::abs(WrapAngle(robot.X_WR.heading - place.X_WR.heading)) > 0.02;
      if (moved || stands || place.since == 0) place = {robot.X_WR, state.tick};
      if (state.tick - place.since != kMinute) continue;
      ++rests_;
      if (HasFreeMotion(state, RobotId(i))) found.push_back(scene_.world().robots[i].name);
    }
    return found;
  }
  int rests() const { return rests_; }

 private:
  struct Place {
    Pose X_WR;
    Tick since = 0;
  };

  bool HasFreeMotion(const WorldState& state, RobotId robot) {
    index_.Assign(state);
    const DriveDescription& drive = scene_.world().robots[robot.index()].drive;
    std::vector<Twist> twists{{0.05, 0.0, 0.0}, {-0.05, 0.0, 0.0}};
    for (const double side : {-1.0, 1.0}) {
      if (drive.type == DriveType::kCar) {
        for (const double speed : {-0.05, 0.05}) twists.push_back({speed, 0.0, side * speed});
      } else {
        twists.push_back({0.0, 0.0, 0.15 * side});
      }
      if (drive.type == DriveType::kOmni) twists.push_back({0.0, 0.05 * side, 0.0});
    }
    for (const Twist& twist : twists) {
      const Motion motion{state.robots[robot.index()].X_WR, twist, 0.0, 1.0};
      if (!FirstContact(scene_, index_, MoverOf(scene_, scene_.body_of(robot)), motion)) return true;
    }
    return false;
  }

  Scene scene_;
  BodyIndex index_;
  std::vector<Place> places_;
  int rests_ = 0;
};

struct Totals {
  int robots = 0;
  int stalls = 0;  // robots and ticks
  int rests = 0;   // of robots that cannot move at all
};

void RunRoom(std::uint64_t seed, double clutter, double crowd, int ticks, Totals& totals) {
  test::RandomStream random(seed);
  Result<WorldDescription> loaded = LoadText(RandomRoom(random, clutter, crowd), seed);
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  WorldDescription& world = loaded.value();
  std::vector<bool> may_stand;
  for (RobotDescription& robot : world.robots) {
    std::size_t kind = random.Index(kKinds.size());
    if (robot.drive.type == DriveType::kCar && std::string(kKinds[kind].controller) == "fetch") kind = 0;
    robot.controller = {kKinds[kind].controller, kKinds[kind].parameters};
    may_stand.push_back(kKinds[kind].may_stand);
  }
  Result<Simulation> made = Simulation::Create(world);
  ASSERT_TRUE(made.ok()) << made.error().ToString();
  Simulation& simulation = made.value();
  RestingRobots resting(simulation.world());
  totals.robots += static_cast<int>(world.robots.size());
  for (int i = 0; i < ticks; ++i) {
    simulation.Step();
    for (const RobotState& robot : simulation.state().robots) totals.stalls += robot.stalled ? 1 : 0;
    for (const std::string& name : resting.Find(simulation.state(), may_stand)) {
      const RobotId robot = *simulation.FindRobot(name);
      ADD_FAILURE() << "seed " << seed << ", " << name << " (" << world.robots[robot.index()].controller.name
                    << ", drive " << static_cast<int>(world.robots[robot.index()].drive.type) << ") rests until tick "
                    << simulation.tick()
                    << (simulation.state().robots[robot.index()].stalled ? ", stalled" : ", on its own");
    }
  }
  EXPECT_TRUE(simulation.failures().empty());
  totals.rests += resting.rests();
}

void RunRooms(std::uint64_t first, std::uint64_t last, int ticks) {
  Totals totals;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const bool is_open = seed % 3 == 0;
    RunRoom(seed, is_open ? 0.0 : 0.25, seed % 3 == 2 ? 0.5 : 0.25, ticks, totals);
  }
  EXPECT_GT(totals.robots, static_cast<int>(5 * (last - first + 1)));
  EXPECT_GT(totals.stalls, totals.robots);
  EXPECT_LE(totals.rests, totals.robots / 50) << "wedged on all sides";
}

TEST(RecoveryProperty, NoRobotWithFreeSpaceAroundItRestsForAMinute) {
  RunRooms(1, 24, 1500);
}

// A test of its own in CTest, with the label slow.
TEST(RecoveryProperty, DISABLED_InManyRoomsNoRobotRestsForAMinute) {
  RunRooms(1001, 1100, 4000);
}

TEST(Recovery, AWandererLeavesAWallThatBlocksItsWayBackAndItsTurn) {
  const std::string file = test::StageWorldsFolder() + "/../cases/wander_freeze.world";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no file " << file;
  Result<Simulation> loaded = Simulation::Load(file);
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  Simulation& simulation = loaded.value();
  Pose rest = simulation.pose(RobotId(0));
  Tick rest_since = 0;
  for (int i = 0; i < 2000; ++i) {
    simulation.Step();
    const Pose& X_WR = simulation.pose(RobotId(0));
    if (X_WR == rest) continue;
    EXPECT_LE(simulation.tick() - rest_since, 100u) << "10 s at rest";
    rest = X_WR;
    rest_since = simulation.tick();
  }
  EXPECT_LE(simulation.tick() - rest_since, 100u) << "10 s at rest";
  EXPECT_GT(simulation.pose(RobotId(0)).translation().norm(), 5.0) << "on the open plane";
}

}  // namespace
}  // namespace troupe
