#include "common/spatial/sweep.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/spatial/convex_piece.h"
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

TEST(PenetrationDepth, DistinguishesOverlappingTouchingAndApart) {
  const Polygon unit = Box(0, 0, 1, 1);
  const struct {
    const char* name;
    Polygon other;
    double depth;
  } cases[] = {
      {"a little from the side", Box(0.9, 0.2, 2, 0.8), 0.1},
      {"a little at the corner", Box(0.9, 0.8, 2, 2), 0.1},
      {"the same", unit, 1.0},
      {"contained", Box(0.4, 0.4, 0.6, 0.6), 0.6},
      {"containing", Box(-1, -1, 2, 2), 2.0},
      {"crossing", Box(-1, 0.4, 2, 0.6), 0.6},
      {"edges touch", Box(1, 0, 2, 1), 0.0},
      {"corners touch", Box(1, 1, 2, 2), 0.0},
      {"apart", Box(1.5, 0, 2, 1), -0.5},
      {"a corner in an edge", {{0.9, 0.5}, {1.5, 0.0}, {1.5, 1.0}}, 0.1},
  };
  for (const auto& c : cases) {
    EXPECT_NEAR(PenetrationDepth(unit, c.other), c.depth, 1e-15) << c.name;
    EXPECT_NEAR(PenetrationDepth(c.other, unit), c.depth, 1e-15) << c.name << ", the other way round";
  }
}

TEST(PenetrationDepth, BoundsTheDistanceFromBelow) {
  const Polygon unit = Box(0, 0, 1, 1);
  const double depth = PenetrationDepth(unit, Box(2, 2, 3, 3));  // corner to corner: sqrt(2) apart
  EXPECT_LT(depth, 0.0);
  EXPECT_LE(-depth, 1.4142135623730951);
}

TEST(OverlapBy, IsTrueWhereTheDepthIsMore) {
  const Polygon unit = Box(0, 0, 1, 1);
  const Polygon others[] = {Box(0.9, 0.2, 2, 0.8), unit, Box(1, 0, 2, 1), Box(1.5, 0, 2, 1), Box(2, 2, 3, 3)};
  for (const Polygon& other : others) {
    const double depth = PenetrationDepth(unit, other);
    EXPECT_FALSE(OverlapBy(unit, other, depth)) << depth;
    EXPECT_TRUE(OverlapBy(unit, other, std::nextafter(depth, -2.0))) << depth;
    EXPECT_FALSE(OverlapBy(unit, other, depth + 0.01)) << depth;
    EXPECT_TRUE(OverlapBy(unit, other, depth - 0.01)) << depth;
  }
}

TEST(StayApart, IsTrueIfANormalShowsAGapDuringTheWholeMotion) {
  const Polygon unit = Box(0, 0, 1, 1);
  const struct {
    const char* name;
    Polygon later;
    Polygon other;
    double margin;
    bool apart;
  } cases[] = {
      {"past a wall", Box(0, 5, 1, 6), Box(1.2, 0, 2, 9), 0.1, true},
      {"past a wall, with a margin that reaches it", Box(0, 5, 1, 6), Box(1.2, 0, 2, 9), 0.21, false},
      {"up to a wall", Box(1, 0, 2, 1), Box(2.2, 0, 3, 1), 0.1, true},
      {"into a wall", Box(1, 0, 2, 1), Box(1.9, 0, 3, 1), 0.0, false},
      {"through a wall, to beyond it", Box(5, 0, 6, 1), Box(2.9, 0, 3, 1), 0.0, false},
      {"away from a wall", Box(-1, 0, 0, 1), Box(1.2, 0, 3, 1), 0.1, true},
      {"from overlap to none", Box(-5, 0, -4, 1), Box(0.9, 0, 3, 1), 0.0, false},
      {"past a corner, shown by its slanting edge", Box(2, 0, 3, 1), {{1.5, 1.2}, {3.5, 3.2}, {1.5, 3.2}}, 0.1, true},
  };
  for (const auto& c : cases) EXPECT_EQ(StayApart(unit, c.later, c.other, c.margin), c.apart) << c.name;
}

TEST(MakePieces, CutsBlocksAndKeepsRectangles) {
  test::TestWorld test;
  const Polygon l_shape{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const ModelId id = test.AddModel({{l_shape, {0.0, 1.0}}, {test::Square(0.5), {1.0, 1.5}}});
  test.world.shapes[0].rectangles = {{0.0, 0.0, 0.1, 0.2}, {0.1, 0.0, 0.2, 0.2}};
  test.world.shapes[0].rectangles_z = {0.0, 0.3};
  test.model(id).obstacle_return = false;
  test.model(id).ranger_return = 0.5;
  const auto pieces = MakePieces(test.world, id, {10.0, 0.0, 2.0, 0.0});
  ASSERT_EQ(pieces.size(), 5u) << "two of the L, a square, two rectangles";
  for (const ConvexPiece& piece : pieces) {
    EXPECT_EQ(piece.model, id);
    EXPECT_FALSE(piece.obstacle);
    EXPECT_EQ(piece.ranger_return, 0.5);
    EXPECT_GT(SignedArea(piece.vertices), 0.0);
  }
  EXPECT_EQ(pieces[0].z, (ZRange{2.0, 3.0}));
  EXPECT_EQ(pieces[2].z, (ZRange{3.0, 3.5}));
  EXPECT_EQ(pieces[3].z, (ZRange{2.0, 2.3}));
  EXPECT_EQ(pieces[3].vertices[0], Vec2(10.0, 0.0));
  EXPECT_EQ(pieces[3].vertices[1], pieces[4].vertices[0]) << "rectangles share their corners to the last bit";
}

TEST(MakePieces, LeavesOutBlocksWithoutHeight) {
  test::TestWorld test;
  const ModelId id = test.AddModel(test::Square(1.0), {0.5, 0.5});
  EXPECT_TRUE(MakePieces(test.world, id, {}).empty());
}

TEST(Transformed, MovesVerticesAndHeights) {
  const ConvexPiece piece{test::Box(0, 0, 2, 1), {0.0, 1.0}, ModelId(3), true, 1.0};
  const ConvexPiece moved = Transformed(piece, {5.0, 5.0, 1.0, kPi / 2.0});
  EXPECT_LT((moved.vertices[1] - Vec2(5.0, 7.0)).norm(), 1e-12);
  EXPECT_LT((moved.vertices[2] - Vec2(4.0, 7.0)).norm(), 1e-12);
  EXPECT_EQ(moved.z, (ZRange{1.0, 2.0}));
  EXPECT_EQ(moved.model, ModelId(3));
}

}  // namespace
}  // namespace troupe
