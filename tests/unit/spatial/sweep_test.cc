#include "common/spatial/sweep.h"

#include <gtest/gtest.h>

#include "tests/support/test_world.h"

namespace troupe {
namespace {

using test::Box;
using test::Square;
using test::TestWorld;

const Polygon kBody = Square(1.0);

std::optional<double> Sweep(const Twist& twist, double duration, const Polygon& other, const Pose& X_WR = {}) {
  return TimeOfContact(kBody, X_WR, twist, duration, other);
}

TEST(TimeOfContact, IsFoundOnAStraightLine) {
  const auto time = Sweep({.vx = 2.0}, 1.0, Box(1.5, -1, 2, 1));
  ASSERT_TRUE(time);
  EXPECT_NEAR(*time, 0.5, 1e-12);
  EXPECT_FALSE(Sweep({.vx = 2.0}, 0.4, Box(1.5, -1, 2, 1)));
  EXPECT_FALSE(Sweep({.vx = -2.0}, 1.0, Box(1.5, -1, 2, 1)));
}

TEST(TimeOfContact, ReachingAWallExactlyIsFree) {
  EXPECT_FALSE(Sweep({.vx = 1.0}, 1.0, Box(1.5, -1, 2, 1)));
}

TEST(TimeOfContact, WithoutMotionIsFree) {
  EXPECT_FALSE(Sweep({}, 1.0, kBody));
  EXPECT_FALSE(Sweep({.vx = 1.0}, 0.0, kBody));
}

TEST(TimeOfContact, IsFoundWhileTurning) {
  // The corner, sqrt(1/2) from the centre, reaches the wall when it has turned to acos(0.6 sqrt(2)).
  const auto time = Sweep({.wz = 1.0}, 3.0, Box(0.6, -2, 1, 2));
  ASSERT_TRUE(time);
  EXPECT_NEAR(*time, kPi / 4.0 - std::acos(0.6 * std::sqrt(2.0)), 1e-12);
  EXPECT_FALSE(Sweep({.wz = 1.0}, 1000.0, Box(0.71, -2, 1, 2))) << "beyond the corner's circle";
}

TEST(TimeOfContact, FindsContactInTheFirstOfManyTurns) {
  // An arm that turns about R's origin touches a post half a turn away.
  const Polygon arm = Box(0, -0.05, 2, 0.05);
  for (double rate : {1.0, -1.0, 100.0, -100.0}) {
    const auto time = TimeOfContact(arm, {}, {.wz = rate}, 10.0, Box(-2, -0.01, -1, 0.01));
    ASSERT_TRUE(time) << rate;
    EXPECT_GT(*time * std::abs(rate), 3.0);
    EXPECT_LT(*time * std::abs(rate), kPi);
  }
}

TEST(TimeOfContact, FollowsTheArc) {
  // Half a circle of radius 2 to the left ends at (0, 4); one post is at its middle, one beside it.
  const Twist twist{.vx = kPi * 2.0, .vy = 0.0, .wz = kPi};
  EXPECT_TRUE(Sweep(twist, 1.0, Box(2.0, 2.0, 2.1, 2.1)));
  EXPECT_FALSE(Sweep(twist, 1.0, Box(-0.1, 1.9, 0.1, 2.1))) << "in the middle of the circle";
  EXPECT_FALSE(Sweep(twist, 1.0, Box(3.0, 2.0, 3.1, 2.1))) << "outside";
}

TEST(TimeOfContact, NeverTunnels) {
  for (double speed : {1.0, 50.0, 1000.0, 1e6}) {
    const auto time = Sweep({.vx = speed}, 1.0, Box(0.8, -1, 0.801, 1));
    ASSERT_TRUE(time) << speed;
    EXPECT_NEAR(*time * speed, 0.3, 1e-9);
  }
}

TEST(TimeOfContact, IsFreeAlongAndAwayFromAWallThatItTouches) {
  const Polygon wall = Box(0.5, -50, 1, 50);
  EXPECT_FALSE(Sweep({.vy = 1.0}, 1.0, wall));
  EXPECT_FALSE(Sweep({.vy = -1.0}, 1.0, wall));
  EXPECT_FALSE(Sweep({.vx = -1.0}, 1.0, wall));
  EXPECT_FALSE(Sweep({.vx = -1.0, .vy = 1.0}, 1.0, wall));
}

TEST(TimeOfContact, IsZeroIntoAWallThatItTouches) {
  const Polygon wall = Box(0.5, -50, 1, 50);
  EXPECT_EQ(Sweep({.vx = 1.0}, 1.0, wall), 0.0);
  EXPECT_EQ(Sweep({.vx = 1e-3, .vy = 1.0}, 1.0, wall), 0.0);
  EXPECT_EQ(Sweep({.wz = 1.0}, 1.0, wall), 0.0) << "a corner turns into it";
}

TEST(TimeOfContact, SqueezesThroughAGapOfItsOwnWidth) {
  EXPECT_FALSE(Sweep({.vx = 5.0}, 1.0, Box(1, 0.5, 2, 3)));
  EXPECT_FALSE(Sweep({.vx = 5.0}, 1.0, Box(1, -3, 2, -0.5)));
  EXPECT_TRUE(Sweep({.vx = 5.0}, 1.0, Box(1, 0.5 - 1e-6, 2, 3)));
}

TEST(TimeOfContact, LetsAnOverlappingBodySeparateButNotMoveDeeper) {
  const Polygon wall = Box(0.4, -50, 10, 50);
  EXPECT_FALSE(Sweep({.vx = -1.0}, 1.0, wall));
  EXPECT_EQ(Sweep({.vx = 1.0}, 1.0, wall), 0.0);
  EXPECT_FALSE(Sweep({.vy = 1.0}, 1.0, wall)) << "along, at the same depth";
}

TEST(TimeOfContact, DependsLittleOnATinyTurn) {
  const Polygon wall = Box(1.5, -1, 2, 1);
  for (double rate : {0.0, 1e-300, 1e-15, 1e-9, -1e-9}) {
    const auto time = Sweep({.vx = 2.0, .vy = 0.0, .wz = rate}, 1.0, wall);
    ASSERT_TRUE(time) << rate;
    EXPECT_NEAR(*time, 0.5, 1e-8) << rate;
  }
}

class FirstContactTest : public testing::Test {
 protected:
  std::optional<Contact> Move(const Twist& twist, double duration = 1.0) const {
    const Scene scene(test_.world);
    BodyIndex robots(scene);
    const WorldState state = PlacedState(scene.world());
    robots.Assign(state);
    const BodyId own(0);
    return FirstContact(scene, robots, MoverOf(scene, own), {state.robots[0].X_WR, twist, 0.0, duration});
  }

  TestWorld test_;
};

TEST_F(FirstContactTest, RespectsHeights) {
  const struct {
    const char* name;
    ZRange z;
    bool meets;
  } cases[] = {
      {"below", {-1.0, 0.1}, false},
      {"above", {0.9, 2.0}, false},
      {"touching below", {0.0, 0.2}, false},
      {"touching above", {0.7, 1.0}, false},
      {"reaching in from below", {0.0, 0.3}, true},
      {"reaching in from above", {0.6, 2.0}, true},
      {"containing", {0.0, 2.0}, true},
      {"contained", {0.3, 0.4}, true},
      {"equal", {0.2, 0.7}, true},
  };
  for (const auto& c : cases) {
    test_ = {};
    test_.AddRobot(Square(0.4), {0.2, 0.7}, {});
    test_.AddModel(Box(0.5, -1, 1, 1), c.z);
    EXPECT_EQ(Move({.vx = 1.0}).has_value(), c.meets) << c.name;
  }
}

TEST_F(FirstContactTest, DrivesUnderATableBetweenItsLegs) {
  test_.AddRobot(Square(0.4), {0.0, 0.5}, {-2.0, 0.0, 0.0, 0.0});
  test_.AddModel(Box(-1, -0.5, 1, 0.5), {0.5, 0.6});
  test_.AddModel(Box(-1, 0.2, -0.9, 0.3), {0.0, 0.5});
  test_.AddModel(Box(-1, -0.3, -0.9, -0.2), {0.0, 0.5});
  EXPECT_FALSE(Move({.vx = 4.0}));
  // With a mast it stops at the contact of the mast with the table top.
  test_.AddModel(Square(0.1), {0.0, 0.5}, {-0.1, 0.0, 0.3, 0.0}, ModelId(0));
  const auto contact = Move({.vx = 4.0});
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->other, ModelId(1));
  EXPECT_NEAR(contact->time * 4.0, 1.0 + 0.1 - 0.05, 1e-9);
}

TEST_F(FirstContactTest, IgnoresModelsThatAreNoObstacles) {
  test_.AddRobot(Square(0.4), {0.0, 0.5}, {});
  const ModelId wall = test_.AddModel(Box(0.5, -1, 1, 1));
  EXPECT_TRUE(Move({.vx = 1.0}));
  test_.model(wall).obstacle_return = false;
  EXPECT_FALSE(Move({.vx = 1.0}));
  test_.model(wall).obstacle_return = true;
  test_.model(ModelId(0)).obstacle_return = false;
  EXPECT_FALSE(Move({.vx = 1.0}));
}

TEST_F(FirstContactTest, FindsOtherRobotsButNotTheMoverItself) {
  test_.AddRobot(Square(0.4), {0.0, 0.5}, {});
  test_.AddModel(Square(0.4), {0.0, 0.5}, {0.1, 0.0, 0.0, 0.3}, ModelId(0));
  EXPECT_FALSE(Move({.vx = 1.0, .wz = 3.0}));
  test_.AddRobot(Square(0.4), {0.0, 0.5}, {1.0, 0.0, 0.0, 0.0});
  const auto contact = Move({.vx = 1.0});
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->other, ModelId(2));
}

TEST_F(FirstContactTest, NamesTheLowestModelOfTwoContactsAtOnce) {
  test_.AddRobot(Square(0.4), {0.0, 0.5}, {});
  test_.AddModel(Box(0.5, 0.0, 1, 1));
  test_.AddModel(Box(0.5, -1, 1, 0.0));
  EXPECT_EQ(Move({.vx = 1.0})->other, ModelId(1));
  std::swap(test_.world.shapes[1], test_.world.shapes[2]);
  EXPECT_EQ(Move({.vx = 1.0})->other, ModelId(1));
}

TEST_F(FirstContactTest, FindsTheGround) {
  test_.AddRobot(Square(0.4), {-0.01, 0.5}, {});
  const auto contact = Move({.wz = 0.1});
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->time, 0.0);
  EXPECT_EQ(contact->other, std::nullopt);
  EXPECT_FALSE(Move({})) << "standing is no motion";
  test_.model(ModelId(0)).X_PM.z = 0.01;
  EXPECT_FALSE(Move({.wz = 0.1})) << "touching the ground is free";
  test_.model(ModelId(0)).X_PM.z = 0.0;
  test_.model(ModelId(0)).obstacle_return = false;
  EXPECT_FALSE(Move({.wz = 0.1}));
}

}  // namespace
}  // namespace troupe
