// go_to, patrol and follow, each with a robot that moves as its drive allows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <queue>
#include <vector>

#include "common/model/device_limits.h"
#include "robot-agent/navigation/mapped_route.h"
#include "tests/support/values.h"
#include "tests/unit/robot-agent/controller/controlled_robot.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

class DrivingTest : public ::testing::Test {
 protected:
  void Make(const std::string& controller, const std::string& parameters, DriveType drive = DriveType::kDifferential) {
    robot_ = MakeRobot(controller, parameters, {}, drive);
    robot_.drive.velocity = {{-1.0, 1.0}, {-1.0, 1.0}, {-1.0, 1.0}};
    robot_.drive.acceleration = {{-0.5, 0.5}, {-0.5, 0.5}, {-1.5, 1.5}};
    robot_.drive.wheelbase = 0.5;
    if (controller == "follow") {
      robot_.sensors.push_back({.name = "finder", .parameters = FiducialParameters{}});
    }
    controller_ = test::ValueOf(CreateFor(robot_));
  }

  // Until the robot stands and `until` is true, or `most` ticks have passed. True if it did.
  template <typename Until>
  bool Drive(int most, Until until) {
    for (int i = 0; i < most; ++i) {
      std::vector<SensorReading> readings(robot_.sensors.size());
      if (!readings.empty()) readings[0] = See();
      Observation observation = At(tick_++, readings);
      observation.pose_estimate = pose_;
      observation.goal = goal_ ? &*goal_ : nullptr;
      Command command = controller_->Update(observation);
      if (!command.say.empty()) said_.push_back(command.say);
      if (robot_.drive.type == DriveType::kCar) {
        command.twist = CarTwist(command.speed, command.steering, robot_.drive.wheelbase);
      }
      twist_ = robot_.drive.type == DriveType::kCar ? command.twist
                                                    : ClampToLimits(robot_.drive, twist_, command.twist, 0.1);
      pose_ = pose_ * Integrate(twist_, 0.1);
      if (until()) return true;
    }
    return false;
  }
  bool StandsAt(const Vec2& point, double within) const {
    return twist_.IsZero() && (pose_.translation() - point).norm() <= within;
  }

  // The leader, as the finder of `follow` sees it in its field of view.
  SensorReading See() const {
    FiducialReading reading;
    const Vec2 p_R = Transform2(pose_).InverseTransform(leader_);
    const double bearing = Atan2(p_R.y(), p_R.x());
    if (std::abs(bearing) < 0.5 * kPi) {
      reading.fiducials.push_back({.id = 4, .range = p_R.norm(), .bearing = bearing, .X_SF = {p_R.x(), p_R.y(), 0, 0}});
    }
    return {.tick = tick_, .content = reading};
  }

  RobotDescription robot_;
  std::unique_ptr<Controller> controller_;
  Pose pose_;
  Twist twist_;
  std::optional<Goal> goal_;
  std::vector<std::string> said_;
  Vec2 leader_{0.0, 0.0};
  Tick tick_ = 0;
};

TEST_F(DrivingTest, GoesToItsWaypointsInOrderAndTurns) {
  Make("go_to", R"({"waypoints": [[2, 0], [2, 2], [-1, 1]], "heading": 1.5})");
  EXPECT_TRUE(Drive(200, [&] { return (pose_.translation() - Vec2(2.0, 0.0)).norm() < 0.1; }));
  EXPECT_TRUE(Drive(200, [&] { return (pose_.translation() - Vec2(2.0, 2.0)).norm() < 0.1; }));
  EXPECT_TRUE(Drive(400, [&] { return StandsAt({-1.0, 1.0}, 0.1); }));
  EXPECT_NEAR(pose_.heading, 1.5, 0.03);
  Drive(50, [] { return false; });
  EXPECT_TRUE(StandsAt({-1.0, 1.0}, 0.1));
}

TEST_F(DrivingTest, BrakesInTime) {
  Make("go_to", R"({"waypoints": [[3, 0]], "speed": 1.0, "tolerance": 0.05})");
  double farthest = 0.0;
  EXPECT_TRUE(Drive(300, [&] {
    farthest = std::max(farthest, pose_.x);
    return StandsAt({3.0, 0.0}, 0.12);
  }));
  EXPECT_LT(farthest, 3.1);
}

TEST_F(DrivingTest, OmniAndCarArriveToo) {
  for (const DriveType drive : {DriveType::kOmni, DriveType::kCar}) {
    for (const char* point : {"[3, 1]", "[-3, 1]", "[0, 0.7]", "[-0.5, 0]"}) {
      pose_ = {};
      twist_ = {};
      Make("go_to", std::string(R"({"tolerance": 0.2, "waypoints": [)") + point + "]}", drive);
      EXPECT_TRUE(Drive(600, [&] { return twist_.IsZero() && tick_ > 5; })) << point;
    }
  }
}

TEST_F(DrivingTest, AGoalOfAUserComesFirstAndThenItsOwnRouteAgain) {
  Make("go_to", R"({"waypoints": [[1, 0]]})");
  EXPECT_TRUE(controller_->AcceptsGoals());
  goal_ = Goal{.number = 7, .waypoints = {{0.0, 2.0}}, .heading = 0.0};
  EXPECT_TRUE(Drive(300, [&] { return StandsAt({0.0, 2.0}, 0.1); }));
  goal_ = Goal{.number = 8, .waypoints = {{-1.0, 2.0}}};
  EXPECT_TRUE(Drive(300, [&] { return StandsAt({-1.0, 2.0}, 0.1); }));
  goal_.reset();
  EXPECT_TRUE(Drive(300, [&] { return StandsAt({1.0, 0.0}, 0.1); }));
}

TEST_F(DrivingTest, SaysOnceThatAGoalOfAUserIsReached) {
  Make("go_to", R"({"waypoints": [[1, 0]]})");
  EXPECT_TRUE(Drive(300, [&] { return StandsAt({1.0, 0.0}, 0.1); }));
  EXPECT_TRUE(said_.empty());
  goal_ = Goal{.number = 7, .waypoints = {{1.0, 1.0}, {0.0, 2.0}}, .heading = 0.0};
  EXPECT_FALSE(Drive(300, [] { return false; }));
  EXPECT_THAT(said_, testing::ElementsAre("reached the goal (0.00, 2.00)"));
  goal_ = Goal{.number = 8, .waypoints = {{-1.0, 2.0}}};
  EXPECT_FALSE(Drive(300, [] { return false; }));
  EXPECT_THAT(said_, testing::ElementsAre(testing::_, "reached the goal (-1.00, 2.00)"));
}

TEST_F(DrivingTest, WithoutAGoalOrWaypointsItStands) {
  Make("go_to", "{}");
  EXPECT_FALSE(Drive(20, [&] { return !twist_.IsZero(); }));
}

TEST_F(DrivingTest, PatrolsRoundAfterRound) {
  Make("patrol", R"({"waypoints": [[1, 0], [1, 1], [0, 0]]})");
  for (int round = 0; round < 3; ++round) {
    for (const Vec2& point : {Vec2(1.0, 0.0), Vec2(1.0, 1.0), Vec2(0.0, 0.0)}) {
      EXPECT_TRUE(Drive(200, [&] { return (pose_.translation() - point).norm() <= 0.1; })) << round;
    }
  }
}

TEST_F(DrivingTest, FollowsALeaderAtItsDistance) {
  Make("follow", R"({"distance": 0.8, "id": 4})");
  leader_ = {3.0, 1.0};
  EXPECT_TRUE(Drive(300, [&] { return std::abs((pose_.translation() - leader_).norm() - 0.8) < 0.1; }));
  leader_ = {2.0, 4.0};
  EXPECT_TRUE(Drive(300, [&] { return std::abs((pose_.translation() - leader_).norm() - 0.8) < 0.1; }));
}

TEST_F(DrivingTest, SearchesALeaderThatIsBehindAndIgnoresOthers) {
  Make("follow", "{}");
  leader_ = {-3.0, -0.5};
  EXPECT_TRUE(Drive(400, [&] { return std::abs((pose_.translation() - leader_).norm() - 1.0) < 0.1; }));
  pose_ = {};
  Make("follow", R"({"id": 5})");
  leader_ = {3.0, 0.0};
  Drive(100, [] { return false; });
  EXPECT_LT(pose_.translation().norm(), 0.2);
}

// Robots whose motions all end at a contact, until they are moved.
TEST_F(DrivingTest, ABlockedRobotTriesMotionsOfAllKinds) {
  const struct {
    const char* controller;
    const char* parameters;
    DriveType drive;
  } cases[] = {{"go_to", R"({"waypoints": [[3, 0]]})", DriveType::kDifferential},
               {"go_to", R"({"waypoints": [[0, 0]], "heading": 2})", DriveType::kDifferential},
               {"go_to", R"({"waypoints": [[3, 0]]})", DriveType::kCar},
               {"patrol", R"({"waypoints": [[3, 0], [0, 3]]})", DriveType::kOmni},
               {"follow", "{}", DriveType::kDifferential},
               {"dynamic", "{}", DriveType::kDifferential},
               {"fetch", R"({"steps": [{"go_to": [-1, 0]}]})", DriveType::kDifferential}};
  for (const auto& c : cases) {
    Make(c.controller, c.parameters, c.drive);
    leader_ = {3.0, 1.0};
    bool ahead = false;
    bool back = false;
    bool left = false;
    bool right = false;
    for (tick_ = 0; tick_ < 600; ++tick_) {
      std::vector<SensorReading> readings(robot_.sensors.size());
      if (!readings.empty()) readings[0] = See();
      const Command command = controller_->Update(At(tick_, readings, tick_ > 0));
      const double speed = command.speed + command.twist.vx;
      const double turn = command.steering + command.twist.wz;
      if (speed > 0.0 && turn == 0.0) ahead = true;
      if (speed < 0.0 && turn == 0.0) back = true;
      if (turn > 0.0) left = true;
      if (turn < 0.0) right = true;
    }
    EXPECT_TRUE(ahead && back && left && right) << c.controller << " " << c.parameters;
  }
}

TEST_F(DrivingTest, WrongParametersAreNamed) {
  const struct {
    const char* controller;
    const char* parameters;
    const char* message;
  } cases[] = {
      {"go_to", R"({"waypoints": [[1]]})", "found an array of 1 as 'waypoints[0]', expected a list of 2 numbers"},
      {"go_to", R"({"waypoints": [[1, 2], [1, "x"]]})",
       "found an array of 2 as 'waypoints[1]', expected a list of 2 numbers"},
      {"go_to", R"({"waypoints": [[1, 2e9]]})", "expected a list of 2 numbers from -1e+06 to 1e+06"},
      {"go_to", R"({"speeed": 1})", "speeed"},
      {"patrol", R"({"waypoints": [[1, 2]]})", "fewer than 2 points"},
      {"patrol", R"({"heading": 1, "waypoints": [[1, 2], [3, 4]]})", "heading"},
      {"follow", R"({"distance": -1})", "distance"},
  };
  for (const auto& c : cases) {
    const Status status = CheckController(c.controller, c.parameters);
    ASSERT_FALSE(status.ok()) << c.parameters;
    EXPECT_NE(status.error().message.find(c.message), std::string::npos) << status.error().message;
  }
  const Result<std::unique_ptr<Controller>> blind = CreateFor(MakeRobot("follow", "{}"));
  ASSERT_FALSE(blind.ok());
  EXPECT_EQ(blind.error().message, "follow: the robot has no fiducial finder, expected one");
}

// The map of a robot and the paths on it.

using Cell = EvidenceGrid::Cell;

Cell CellAt(const EvidenceGrid& grid, double x, double y) {
  return grid[*grid.IndexOf({x, y})];
}

// All cells are seen from within themselves.
void See(EvidenceGrid& grid, std::size_t index, bool occupied) {
  grid.Observe(grid.CenterOf(index), {1.0, 0.0}, 0.0, occupied);
}

TEST(EvidenceGridTest, ARayFreesItsCellsAndOccupiesThatOfItsHit) {
  EvidenceGrid grid({0.0, 0.0}, 10.0, 0.5);
  EXPECT_EQ(grid.width(), 20u);
  grid.Observe({0.1, 0.1}, {1.0, 0.0}, 2.5, true);
  for (const double x : {0.1, 0.6, 1.1, 1.6, 2.1}) EXPECT_EQ(CellAt(grid, x, 0.1), Cell::kFree) << x;
  EXPECT_EQ(CellAt(grid, 2.6, 0.1), Cell::kOccupied);
  EXPECT_EQ(CellAt(grid, 3.1, 0.1), Cell::kUnknown);
  EXPECT_EQ(CellAt(grid, 0.1, 0.6), Cell::kUnknown);
  grid.Observe({0.1, 0.1}, {0.0, 1.0}, 100.0, false);  // beyond the edge
  EXPECT_EQ(CellAt(grid, 0.1, 4.9), Cell::kFree);
}

TEST(EvidenceGridTest, ABodyThatLeavesIsForgotten) {
  EvidenceGrid grid({0.0, 0.0}, 10.0, 0.5);
  for (int i = 0; i < 50; ++i) grid.Observe({0.1, 0.1}, {1.0, 0.0}, 2.5, true);
  EXPECT_EQ(CellAt(grid, 2.6, 0.1), Cell::kOccupied);
  int seen_through = 0;
  while (CellAt(grid, 2.6, 0.1) == Cell::kOccupied && seen_through < 100) {
    grid.Observe({0.1, 0.1}, {1.0, 0.0}, 4.0, false);
    ++seen_through;
  }
  EXPECT_GT(seen_through, 2) << "one reading proves nothing";
  EXPECT_LT(seen_through, 20);
}

TEST(EvidenceGridTest, PointsOutsideHaveNoCell) {
  const EvidenceGrid grid({5.0, 5.0}, 2.0, 0.1);
  EXPECT_TRUE(grid.IndexOf({4.01, 5.99}));
  EXPECT_FALSE(grid.IndexOf({3.99, 5.0}));
  EXPECT_FALSE(grid.IndexOf({5.0, 6.01}));
  EXPECT_FALSE(grid.IndexOf({std::nan(""), 5.0}));
  const std::size_t index = *grid.IndexOf({4.55, 5.25});
  EXPECT_NEAR((grid.CenterOf(index) - Vec2(4.55, 5.25)).norm(), 0.0, 1e-9);
}

// A wall across the grid with a gap at its upper end.
EvidenceGrid GridWithAWall() {
  EvidenceGrid grid({0.0, 0.0}, 10.0, 0.25);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec2 center = grid.CenterOf(i);
    See(grid, i, std::abs(center.x()) < 0.2 && center.y() < 3.0);
  }
  return grid;
}

TEST(PlanPathTest, LeadsThroughTheGapAtADistanceFromTheWall) {
  const EvidenceGrid grid = GridWithAWall();
  const auto path = PlanPath(grid, {-3.0, -3.0}, {3.0, -3.0}, 0.3, 0.6);
  ASSERT_TRUE(path);
  double highest = -10.0;
  Vec2 before(-3.0, -3.0);
  for (const Vec2& point : *path) {
    EXPECT_LT((point - before).norm(), 0.5) << "steps to neighbours";
    before = point;
    highest = std::max(highest, point.y());
    EXPECT_TRUE(point.y() >= 2.0 || std::abs(point.x()) > 0.6) << point.transpose();
  }
  EXPECT_GT(highest, 3.4);
  EXPECT_LE((path->back() - Vec2(3.0, -3.0)).norm(), 0.3);
}

TEST(PlanPathTest, SqueezesThroughWhereThereIsNoOtherWay) {
  const EvidenceGrid grid = GridWithAWall();
  const auto path = PlanPath(grid, {-3.0, 0.0}, {3.0, 0.0}, 0.3, 1.9);
  ASSERT_TRUE(path);
  EXPECT_LE((path->back() - Vec2(3.0, 0.0)).norm(), 0.3);
}

TEST(PlanPathTest, NamesNoWayWhereThereIsNone) {
  EvidenceGrid grid = GridWithAWall();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (std::abs(grid.CenterOf(i).x()) < 0.2) {
      for (int k = 0; k < 20; ++k) See(grid, i, true);
    }
  }
  EXPECT_FALSE(PlanPath(grid, {-3.0, 0.0}, {3.0, 0.0}, 0.3, 0.3));
  EXPECT_FALSE(PlanPath(grid, {-3.0, 0.0}, {30.0, 0.0}, 0.3, 0.3)) << "outside";
  EXPECT_FALSE(PlanToUnknown(grid, {-3.0, 0.0}, 0.3)) << "all is known";
}

TEST(PlanPathTest, FindsTheNearestUnknownPlace) {
  EvidenceGrid grid({0.0, 0.0}, 10.0, 0.25);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec2 center = grid.CenterOf(i);
    if (center.x() < 1.0 && !(center.x() < -2.0 && center.y() < -2.0)) See(grid, i, false);
  }
  const auto path = PlanToUnknown(grid, {0.0, 0.0}, 0.3);
  ASSERT_TRUE(path);
  EXPECT_EQ(CellAt(grid, path->back().x(), path->back().y()), Cell::kUnknown);
  EXPECT_NEAR(path->back().x(), 1.125, 1e-9);
}

// On random grids a way is found exactly if a search over neighbours reaches the goal.
TEST(PlanPathTest, FindsAWayIfAndOnlyIfThereIsOne) {
  int reached = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    EvidenceGrid grid({0.0, 0.0}, 4.0, 0.25);
    const auto width = static_cast<std::int64_t>(grid.width());
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double draw = RandomUniform({seed, i});
      if (draw < 0.9) See(grid, i, draw < 0.45);
    }
    const std::size_t start = 0;
    const std::size_t goal = grid.size() - 1;
    std::vector<bool> seen(grid.size(), false);
    std::queue<std::size_t> open;
    open.push(start);
    seen[start] = true;
    while (!open.empty()) {
      const auto cell = static_cast<std::int64_t>(open.front());
      open.pop();
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        for (std::int64_t dx = -1; dx <= 1; ++dx) {
          const std::int64_t x = cell % width + dx;
          const std::int64_t y = cell / width + dy;
          if (x < 0 || y < 0 || x >= width || y >= width) continue;
          const auto next = static_cast<std::size_t>(y * width + x);
          if (seen[next] || grid[next] == Cell::kOccupied) continue;
          seen[next] = true;
          open.push(next);
        }
      }
    }
    const auto path = PlanPath(grid, grid.CenterOf(start), grid.CenterOf(goal), 0.1, 0.3);
    // The reach is a cell, so that a neighbour of the goal counts.
    const bool expected = seen[goal] || seen[goal - 1] || seen[goal - grid.width()];
    ASSERT_EQ(path.has_value(), expected) << seed;
    if (!path) continue;
    ++reached;
    Vec2 before = grid.CenterOf(start);
    for (const Vec2& point : *path) {
      ASSERT_NE(CellAt(grid, point.x(), point.y()), Cell::kOccupied);
      ASSERT_LT((point - before).norm(), 0.36);
      before = point;
    }
  }
  EXPECT_GT(reached, 20);
  EXPECT_LT(reached, 290);
}

}  // namespace
}  // namespace troupe
