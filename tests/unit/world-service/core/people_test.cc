// The walks of people: goals, ways around walls, reactions to robots, groups, doors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/model/states.h"
#include "common/spatial/walk_routes.h"
#include "tests/support/people_run.h"
#include "tests/support/people_world.h"
#include "tests/support/values.h"
#include "troupe/random.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/find_overlap.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::Box;
using test::PeopleRun;
using test::PeopleWorld;

TEST(People, APersonWalksAroundAWallToItsGoalWaitsThereAndChoosesAnother) {
  PeopleWorld test;
  test.AddModel(Box(4.0, -6.0, 4.2, 1.0), {0.0, 2.0});
  const PersonId anna = test.AddPerson({0.0, 0.0}, test.AddGoals({{8.0, 0.0}, {0.0, 0.0}}, {2.0, 2.0}));
  test.world.goal_sets[0].reach = 0.2;
  PeopleRun run(test.world);
  run.state.people[0].goals_chosen = 1;  // on its way to the first point
  double length = 0.0;
  int arrival = 0;
  while (arrival < 200 && run.state.people[0].dwell_ticks == 0) {
    const Vec2 before = run.Place(anna);
    run.Step();
    length += (run.Place(anna) - before).norm();
    ++arrival;
  }
  EXPECT_LT((run.Place(anna) - Vec2(8.0, 0.0)).norm(), 0.2);
  // The way around the end of the wall is 8.3 m long for a point.
  EXPECT_GT(length, 8.0);
  EXPECT_LT(length, 9.5);
  EXPECT_NEAR(0.1 * arrival, length / 1.3, 1.5);  // s, at its speed
  int waited = 0;
  for (; run.state.people[0].goals_chosen == 1; ++waited) run.Step();
  EXPECT_EQ(waited, 20);
  EXPECT_EQ(run.state.people[0].goal, 1u);
}

TEST(People, APersonWithoutAWayStaysAndOneWithoutGoalsStands) {
  PeopleWorld test;
  for (const Polygon& wall :
       {Box(-2.0, -2.0, 2.0, -1.9), Box(-2.0, 1.9, 2.0, 2.0), Box(-2.0, -1.9, -1.9, 1.9), Box(1.9, -1.9, 2.0, 1.9)}) {
    test.AddModel(wall, {0.0, 2.0});
  }
  const PersonId locked_in = test.AddPerson({0.0, 0.0}, test.AddGoals({{8.0, 0.0}, {9.0, 0.0}}));
  const PersonId standing = test.AddPerson({5.0, 0.0}, test.AddGoals({}));
  PeopleRun run(test.world);
  for (int i = 0; i < 50; ++i) run.Step();
  EXPECT_LT(run.Place(locked_in).norm(), 0.1);
  EXPECT_LE(run.state.people[locked_in.index()].goals_chosen, 6u);  // it looks for a way once a second
  EXPECT_EQ(run.Place(standing), Vec2(5.0, 0.0));
}

// The line from there to its goal has 4 million cells, more than a test should look at in each tick.
TEST(People, APersonFarBeyondTheWorldWalksStraightBackToIt) {
  PeopleWorld test;
  test.AddModel(Box(4.0, -1.0, 4.1, 1.0), {0.0, 2.0});
  test.AddPerson({0.0, 0.0}, test.AddGoals({{8.0, 0.0}}));
  PeopleRun run(test.world);
  run.state.people[0].X_WP.x = -400'000.0;
  for (int i = 0; i < 1000; ++i) run.Step();
  EXPECT_NEAR(run.Place(PersonId(0)).x(), -400'000.0 + 130.0, 3.0);
  EXPECT_NEAR(run.Place(PersonId(0)).y(), 0.0, 3.0);
  const WalkRoutes::Goal goal{0, 0};
  const std::optional<WalkRoutes::Ahead> ahead = run.scene->walk_routes().AheadTo(PersonId(0), goal, {-400'000.0, 0.0});
  ASSERT_TRUE(ahead);
  EXPECT_LT(ahead->point.x(), 0.0) << "the edge of the grid, not the goal";
}

// The least distance between the axis of a person and the origin of a robot that stands on its way, and the distance at
// the end.
struct Passing {
  double least = 1e9;
  double end = 0.0;
  bool has_passed = false;
};

Passing PassARobot(PersonReaction reaction, int ticks) {
  PeopleWorld test;
  const RobotId robot = test.AddRobot(test::Square(0.5), {0.0, 0.6}, {5.0, 0.05, 0.0, 0.0});
  const PersonId person = test.AddPerson({0.0, 0.0}, test.AddGoals({{10.0, 0.0}}), reaction);
  PeopleRun run(test.world);
  Passing passing;
  for (int i = 0; i < ticks; ++i) {
    run.Step();
    passing.end = (run.Place(person) - run.state.robots[robot.index()].X_WR.translation()).norm();
    passing.least = std::min(passing.least, passing.end);
  }
  passing.has_passed = run.Place(person).x() > 9.0;
  return passing;
}

TEST(People, ReactionsToRobotsDiffer) {
  const Passing regular = PassARobot(PersonReaction::kRegular, 150);
  EXPECT_TRUE(regular.has_passed);
  EXPECT_GT(regular.least, 0.25 + 0.25);
  EXPECT_LT(regular.least, 1.0);
  const Passing scared = PassARobot(PersonReaction::kScared, 300);
  EXPECT_GT(scared.least, regular.least + 0.3);
  const Passing curious = PassARobot(PersonReaction::kCurious, 80);
  EXPECT_FALSE(curious.has_passed);
  EXPECT_NEAR(curious.end, 1.2 + 0.25 * std::sqrt(2.0), 0.3);  // it watches the robot
  EXPECT_TRUE(PassARobot(PersonReaction::kCurious, 300).has_passed);
  const Passing careless = PassARobot(PersonReaction::kCareless, 150);
  EXPECT_FALSE(careless.has_passed);  // it stands before the robot
  EXPECT_NEAR(careless.least, 0.5, 0.1);
}

TEST(People, AGroupStaysTogether) {
  PeopleWorld test;
  test.AddModel(Box(9.0, -5.0, 9.2, 0.5), {0.0, 2.0});
  const std::uint32_t goals = test.AddGoals({{20.0, 0.0}});
  for (int i = 0; i < 3; ++i) test.AddPerson({0.0, 0.7 * i}, goals);
  test.world.people[1].leader = test.world.people[2].leader = PersonId(0);
  test.world.people[2].speed = 0.8;
  test.world.people[2].max_speed = 1.0;
  PeopleRun run(test.world);
  double farthest = 0.0;
  for (int i = 0; i < 300; ++i) {
    run.Step();
    for (const PersonId other : {PersonId(1), PersonId(2)}) {
      farthest = std::max(farthest, (run.Place(other) - run.Place(PersonId(0))).norm());
    }
  }
  EXPECT_LT(farthest, 4.5);
  EXPECT_LT((run.Place(PersonId(0)) - Vec2(20.0, 0.0)).norm(), 1.0);
}

TEST(People, AMovedPersonWalksOnFromThereAndADeletedOneIsNoBody) {
  PeopleWorld test;
  const PersonId anna = test.AddPerson({0.0, 0.0}, test.AddGoals({{8.0, 0.0}}));
  test.AddPerson({0.0, 3.0}, 0);
  PeopleRun run(test.world);
  for (int i = 0; i < 5; ++i) run.Step();
  const std::string name = test.world.model(test.world.person(anna).root).name;
  const EditedWorld moved = test::ValueOf(SetPose(run.scene, run.state, name, {2.0, 1.0, 0.0, 0.0}));
  EXPECT_EQ(moved.state.people[0].X_WP, (Pose{2.0, 1.0, 0.0, 0.0}));
  EXPECT_EQ(moved.state.people[0].vx, 0.0);
  const Result<EditedWorld> taken = SetPose(run.scene, run.state, name, run.state.people[1].X_WP);
  ASSERT_FALSE(taken.ok());
  EXPECT_EQ(taken.error().code, ErrorCode::kNoRoom);
  const EditedWorld deleted = test::ValueOf(DeleteEntity(run.scene, run.state, name));
  const WorldState next = Step(*deleted.scene, deleted.state, {}).state;
  EXPECT_EQ(next.people[0].X_WP, deleted.state.people[0].X_WP);
  EXPECT_NE(next.people[1].X_WP, deleted.state.people[1].X_WP);
  EXPECT_TRUE(deleted.scene->body(deleted.scene->body_of(anna)).pieces.empty());
}

TEST(People, ARobotStopsAtAPerson) {
  PeopleWorld test;
  test.AddRobot(test::Square(0.5), {0.0, 0.6}, {0.0, 0.0, 0.0, 0.0});
  const PersonId person = test.AddPerson({2.0, 0.0}, test.AddGoals({}));
  // Walls on both sides, so that the person cannot make way.
  test.AddModel(Box(1.0, 0.26, 3.0, 0.4), {0.0, 2.0});
  test.AddModel(Box(1.0, -0.4, 3.0, -0.26), {0.0, 2.0});
  test.AddModel(Box(2.3, -0.2, 2.5, 0.2), {0.0, 2.0});
  PeopleRun run(test.world);
  for (int i = 0; i < 40; ++i) run.Step({{RobotId(0), Twist{0.5, 0.0, 0.0}}});
  EXPECT_TRUE(run.state.robots[0].stalled);
  EXPECT_LT(run.state.robots[0].X_WR.x, 2.1 - 0.25 - 0.23);
  EXPECT_FALSE(FindOverlap(*run.scene, run.state, run.scene->world().person(person).root));
}

TEST(WalkRoutes, AGoalInAWallIsThePlaceBesideIt) {
  PeopleWorld test;
  test.AddModel(Box(4.0, -1.0, 5.0, 1.0), {0.0, 2.0});
  test.AddPerson({0.0, 0.0}, test.AddGoals({{4.3, 0.0}, {-3.0, 0.0}}));
  const Scene scene(test.world);
  const WalkRoutes& routes = scene.walk_routes();
  const std::optional<Vec2> target = routes.Target(PersonId(0), {0, 0});
  ASSERT_TRUE(target);
  EXPECT_NEAR(target->x(), 3.7, 0.11);
  EXPECT_EQ(*routes.Target(PersonId(0), {0, 1}), Vec2(-3.0, 0.0));
  EXPECT_NEAR(*routes.Length(PersonId(0), WalkRoutes::Goal{0, 1}, {0.0, 0.0}), 3.0, 0.1);
  EXPECT_EQ(routes.AheadTo(PersonId(0), WalkRoutes::Goal{0, 1}, {0.0, 0.0})->point, Vec2(-3.0, 0.0));
}

// Of more goals than fields that are kept each way is the same whenever it is asked for.
TEST(WalkRoutes, WaysThatWereDroppedAreMadeAgain) {
  PeopleWorld test;
  test.AddModel(Box(4.0, -1.0, 5.0, 1.0), {0.0, 2.0});
  std::vector<Vec2> points;
  for (int i = 0; i < 40; ++i) points.emplace_back(8.0 + i, 0.5 * i);
  points.push_back(points.front());
  test.AddPerson({0.0, 0.0}, test.AddGoals(points));
  const Scene scene(test.world);
  const WalkRoutes routes(scene, 0);
  std::vector<double> lengths;
  for (const int round : {0, 1}) {
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const double length = *routes.Length(PersonId(0), WalkRoutes::Goal{0, i}, {0.0, 0.0});
      EXPECT_GT(length, 8.0 + 0.9 * (i % 40));
      if (round == 0) lengths.push_back(length);
      EXPECT_EQ(length, lengths[i]);
    }
  }
  EXPECT_EQ(lengths.front(), lengths.back()) << "of one point";
}

}  // namespace
}  // namespace troupe
