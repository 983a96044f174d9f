#include "common/spatial/scene.h"

#include <gtest/gtest.h>

#include "tests/support/test_world.h"

namespace troupe {
namespace {

TEST(Scene, SeparatesStaticModelsFromBodies) {
  test::TestWorld test;
  const ModelId table = test.AddModel(test::Square(2.0), {0.0, 0.7}, {5.0, 5.0, 0.0, 0.0});
  const ModelId lamp = test.AddModel(test::Square(0.2), {0.0, 0.3}, {0.5, 0.0, 0.7, 0.0}, table);
  const RobotId robot = test.AddRobot(test::Square(0.4), {0.0, 0.5}, {1.0, 2.0, 0.0, 1.0});
  const ModelId root = test.world.robot(robot).root;
  const ModelId mast = test.AddModel(test::Square(0.1), {0.0, 1.0}, {0.3, 0.0, 0.5, 0.0}, root);
  const Scene scene(test.world);

  ASSERT_EQ(scene.static_index().kept_pieces().size(), 2u);
  EXPECT_EQ(scene.static_index().kept_pieces()[1].model, lamp);
  EXPECT_EQ(scene.static_index().bounds(), (Rectangle{4.0, 4.0, 6.0, 6.0}));
  EXPECT_EQ(scene.static_index().kept_pieces()[1].z, (ZRange{0.7, 1.0}));

  EXPECT_EQ(scene.robot_of(table), std::nullopt);
  EXPECT_EQ(scene.robot_of(lamp), std::nullopt);
  EXPECT_EQ(scene.robot_of(root), robot);
  EXPECT_EQ(scene.robot_of(mast), robot);
  EXPECT_EQ(scene.X_RM(root), Pose{});
  EXPECT_EQ(scene.X_RM(mast), (Pose{0.3, 0.0, 0.5, 0.0}));

  const Body& body = scene.body(scene.body_of(robot));
  ASSERT_EQ(body.pieces.size(), 2u);
  EXPECT_EQ(body.z, (ZRange{0.0, 1.5}));
  EXPECT_NEAR(body.radius, std::hypot(0.35, 0.05), 1e-15);
  EXPECT_EQ(scene.max_body_radius(), body.radius);
}

TEST(Scene, AcceptsARobotWithoutABody) {
  test::TestWorld test;
  test.AddRobot(test::Square(0.4), {0.0, 0.5}, {});
  test.world.shapes[0].blocks.clear();
  const Scene scene(test.world);
  EXPECT_TRUE(scene.body(BodyId(0)).pieces.empty());
  EXPECT_EQ(scene.body(BodyId(0)).radius, 0.0);
}

}  // namespace
}  // namespace troupe
