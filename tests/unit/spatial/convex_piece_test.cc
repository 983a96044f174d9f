#include "common/spatial/convex_piece.h"

#include <gtest/gtest.h>

#include "tests/support/test_world.h"

namespace troupe {
namespace {

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
