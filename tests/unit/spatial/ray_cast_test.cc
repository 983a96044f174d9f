#include "common/spatial/ray_cast.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_world.h"

namespace troupe {
namespace {

using test::Box;
using test::Square;
using test::TestWorld;

class RayCastTest : public testing::Test {
 protected:
  std::optional<RayHit> Cast(const Vec2& origin, const Vec2& direction, double z = 0.5, double max_distance = 10.0,
                             std::optional<RobotId> caster = {}) const {
    const Scene scene(test_.world);
    BodyIndex robots(scene);
    robots.Assign(PlacedState(scene.world()));
    return CastRay(scene, robots, {origin, direction, z, max_distance}, caster);
  }

  TestWorld test_;
};

TEST_F(RayCastTest, HitsTheNearestFace) {
  test_.AddModel(Box(5, -1, 6, 1));
  const ModelId near = test_.AddModel(Box(2, -1, 3, 1));
  const auto hit = Cast({0, 0}, {1, 0});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->distance, 2.0);
  EXPECT_EQ(hit->model, near);
  EXPECT_FALSE(Cast({0, 0}, {-1, 0}));
  EXPECT_EQ(Cast({4, 0}, {-1, 0})->distance, 1.0);
  EXPECT_EQ(Cast({2.5, 4}, {0, -1})->distance, 3.0);
}

TEST_F(RayCastTest, ReachesExactlyToItsLength) {
  test_.AddModel(Box(2, -1, 3, 1));
  EXPECT_TRUE(Cast({0, 0}, {1, 0}, 0.5, 2.0));
  EXPECT_FALSE(Cast({0, 0}, {1, 0}, 0.5, 1.999999));
  EXPECT_FALSE(Cast({0, 0}, {1, 0}, 0.5, 0.0));
}

TEST_F(RayCastTest, SeesOnlyItsOwnHeight) {
  test_.AddModel(Box(2, -1, 3, 1), {0.4, 0.6});
  EXPECT_FALSE(Cast({0, 0}, {1, 0}, 0.39));
  EXPECT_TRUE(Cast({0, 0}, {1, 0}, 0.4));
  EXPECT_TRUE(Cast({0, 0}, {1, 0}, 0.5));
  EXPECT_FALSE(Cast({0, 0}, {1, 0}, 0.6)) << "the top belongs to the space above";
}

TEST_F(RayCastTest, LooksThroughTransparentModels) {
  test_.model(test_.AddModel(Box(2, -1, 3, 1))).ranger_return = -1.0;
  EXPECT_FALSE(Cast({0, 0}, {1, 0}));
  test_.model(ModelId(0)).ranger_return = 0.0;
  test_.model(ModelId(0)).obstacle_return = false;
  EXPECT_TRUE(Cast({0, 0}, {1, 0})) << "dark and no obstacle, but seen";
}

TEST_F(RayCastTest, ReadsZeroInsideABlock) {
  const ModelId block = test_.AddModel(Box(-1, -1, 1, 1));
  for (const Vec2& direction : {Vec2(1, 0), Vec2(0, -1), Vec2(0.6, 0.8)}) {
    const auto hit = Cast({0.2, 0.3}, direction);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->distance, 0.0);
    EXPECT_EQ(hit->model, block);
  }
}

TEST_F(RayCastTest, LeavesAFaceThatItStartsOn) {
  test_.AddModel(Box(-1, -1, 0, 1));
  EXPECT_FALSE(Cast({0, 0}, {1, 0})) << "away from the face";
  EXPECT_EQ(Cast({0, 0}, {-1, 0})->distance, 0.0) << "into it";
}

TEST_F(RayCastTest, NamesTheLowestModelOfTwoAtTheSameDistance) {
  const ModelId first = test_.AddModel(Box(2, -1, 3, 1));
  test_.AddModel(Box(2, -1, 3, 1));
  EXPECT_EQ(Cast({0, 0}, {1, 0})->model, first);
  const RobotId robot = test_.AddRobot(Box(2, -1, 3, 1), {0.0, 1.0}, {});
  EXPECT_EQ(Cast({0, 0}, {1, 0})->model, first);
  test_.model(first).ranger_return = -1.0;
  EXPECT_EQ(Cast({0, 0}, {1, 0})->model, ModelId(1));
  test_.model(ModelId(1)).ranger_return = -1.0;
  EXPECT_EQ(Cast({0, 0}, {1, 0})->model, test_.world.robot(robot).root);
}

TEST_F(RayCastTest, SeesOtherRobotsButNotItsOwn) {
  const RobotId self = test_.AddRobot(Square(1.0), {0.0, 1.0}, {});
  test_.AddModel(Square(0.2), {0.0, 1.0}, {0.6, 0.0, 0.0, 0.0}, test_.world.robot(self).root);
  const RobotId other = test_.AddRobot(Square(1.0), {0.0, 1.0}, {4.0, 0.0, 0.0, 0.0});
  const ModelId mast = test_.AddModel(Square(0.2), {1.0, 1.0}, {0.0, 0.0, 0.0, 0.0}, test_.world.robot(other).root);
  const auto hit = Cast({0, 0}, {1, 0}, 0.5, 10.0, self);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->distance, 3.5);
  EXPECT_EQ(hit->model, test_.world.robot(other).root);
  EXPECT_EQ(Cast({0, 0}, {1, 0}, 0.5, 10.0)->distance, 0.0) << "without a caster everything counts";
  test_.world.shapes[test_.model(mast).shape.index()].blocks[0].z = {1.0, 2.0};
  EXPECT_EQ(Cast({0, 0}, {1, 0}, 1.5, 10.0, self)->model, mast);
}

TEST_F(RayCastTest, RunsAlongAWall) {
  const ModelId wall = test_.AddModel(Box(2, 0, 3, 1));
  const auto along = Cast({0, 0}, {1, 0});
  ASSERT_TRUE(along) << "the edge belongs to the wall";
  EXPECT_EQ(along->distance, 2.0);
  EXPECT_EQ(along->model, wall);
  EXPECT_FALSE(Cast({0, -1e-9}, {1, 0}));
}

TEST(CastRays, FillsOneEntryForEachRay) {
  TestWorld test;
  test.AddModel(Box(2, -5, 3, 5));
  const Scene scene(test.world);
  BodyIndex robots(scene);
  robots.Assign(PlacedState(scene.world()));
  std::vector<std::optional<RayHit>> hits(7);
  const double kHalf = std::sqrt(0.5);
  std::vector<Ray> rays;
  for (const Vec2& direction : {Vec2(1, 0), Vec2(-1, 0), Vec2(kHalf, -kHalf)}) {
    rays.push_back({{0, 0}, direction, 0.5, 10.0});
  }
  CastRays(scene, robots, rays, std::nullopt, hits);
  ASSERT_EQ(hits.size(), 3u);
  EXPECT_NEAR(hits[0]->distance, 2.0, 1e-15);
  EXPECT_FALSE(hits[1]);
  EXPECT_NEAR(hits[2]->distance, 2.0 * 1.4142135623730951, 1e-14);
  CastRays(scene, robots, {}, std::nullopt, hits);
  EXPECT_TRUE(hits.empty());
}

}  // namespace
}  // namespace troupe
