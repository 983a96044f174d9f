#include "common/spatial/body_index.h"

#include <gtest/gtest.h>

#include "tests/support/test_world.h"

namespace troupe {
namespace {

std::pmr::vector<BodyId> Find(const BodyIndex& index, const Rectangle& box) {
  std::pmr::vector<BodyId> result;
  index.Query(box, result);
  return result;
}

Rectangle Around(double x, double y) {
  return {x - 0.01, y - 0.01, x + 0.01, y + 0.01};
}

TEST(BodyIndex, IsEmptyWithoutRobots) {
  const Scene scene{WorldDescription{}};
  BodyIndex index(scene);
  index.Assign({});
  EXPECT_TRUE(Find(index, {-1e6, -1e6, 1e6, 1e6}).empty());
}

// With so many others far away, that they need a grid, or without.
class BodyIndexMoves : public testing::TestWithParam<int> {};

TEST_P(BodyIndexMoves, AreFollowed) {
  test::TestWorld test;
  for (int i = 0; i < 3; ++i) test.AddRobot(test::Square(0.4), {0.0, 1.0}, {2.0 * i, 0.0, 0.0, 0.0});
  for (int i = 0; i < GetParam(); ++i) test.AddRobot(test::Square(0.4), {0.0, 1.0}, {2.0 * i, 20.0, 0.0, 0.0});
  const Scene scene(test.world);
  BodyIndex index(scene);
  index.Assign(PlacedState(scene.world()));
  EXPECT_EQ(Find(index, Around(0.1, 0.1)), (std::pmr::vector<BodyId>{BodyId(0)}));
  EXPECT_EQ(Find(index, {-9, -9, 9, 9}), (std::pmr::vector<BodyId>{BodyId(0), BodyId(1), BodyId(2)}));
  index.Move(BodyId(0), {4.0, 0.1, 0.0, 1.0});
  EXPECT_TRUE(Find(index, Around(0.1, 0.1)).empty());
  EXPECT_EQ(Find(index, Around(4.0, 0.1)), (std::pmr::vector<BodyId>{BodyId(0), BodyId(2)}));
  index.Move(BodyId(1), {1e9, -1e9, 0.0, 0.0});
  EXPECT_EQ(Find(index, Around(1e9, -1e9)), (std::pmr::vector<BodyId>{BodyId(1)})) << "far outside the grid";
}

INSTANTIATE_TEST_SUITE_P(Others, BodyIndexMoves, testing::Values(0, 300));

TEST(BodyIndex, CopesWithThousandsOfRobots) {
  test::TestWorld test;
  for (int i = 0; i < 10'000; ++i) {
    test.AddRobot(test::Square(0.4), {0.0, 1.0}, {1.0 * (i % 100), 1.0 * (i / 100), 0.0, 0.0});
  }
  const Scene scene(test.world);
  WorldState state = PlacedState(scene.world());
  BodyIndex index(scene);
  for (int tick = 0; tick < 10; ++tick) {
    for (RobotState& robot : state.robots) robot.X_WR.x += 0.01;
    index.Assign(state);
  }
  EXPECT_EQ(Find(index, Around(50.1, 50.0)), (std::pmr::vector<BodyId>{BodyId(5050)}));
}

TEST(BodyIndex, CopesWithAllRobotsInOnePlace) {
  test::TestWorld test;
  for (int i = 0; i < 500; ++i) test.AddRobot(test::Square(0.4), {0.0, 1.0}, {1.0, 1.0, 0.0, 0.0});
  const Scene scene(test.world);
  BodyIndex index(scene);
  index.Assign(PlacedState(scene.world()));
  index.Assign(PlacedState(scene.world()));
  EXPECT_EQ(Find(index, Around(1.0, 1.0)).size(), 500u);
  EXPECT_TRUE(Find(index, Around(3.0, 1.0)).empty());
}

}  // namespace
}  // namespace troupe
