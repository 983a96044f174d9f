#include "common/spatial/static_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

#include "common/spatial/body_index.h"
#include "common/spatial/grid.h"
#include "common/spatial/occupancy_grid.h"
#include "common/spatial/scene.h"
#include "tests/support/small_world.h"
#include "tests/support/test_world.h"
#include "troupe/random.h"

namespace troupe {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ConvexPiece PieceAt(const Rectangle& r) {
  return {test::Box(r.min_x, r.min_y, r.max_x, r.max_y), {0.0, 1.0}, {}, true, 1.0};
}

// Numbers of kept pieces.
std::vector<std::ptrdiff_t> Find(const StaticIndex& index, const Rectangle& box) {
  NearPieces near;
  index.Query(box, near);
  std::vector<std::ptrdiff_t> result;
  for (const ConvexPiece* piece : near) result.push_back(piece - index.kept_pieces().data());
  return result;
}

TEST(StaticIndex, IsEmptyWithoutPieces) {
  for (const StaticIndex& index : {StaticIndex(), StaticIndex(std::vector<ConvexPiece>{})}) {
    EXPECT_TRUE(Find(index, {-1e6, -1e6, 1e6, 1e6}).empty());
    EXPECT_TRUE(index.bounds().empty());
    index.WalkRay({0, 0}, {1, 0}, {1, kInfinity}, 10.0, [](std::span<const std::uint32_t>, double) {
      ADD_FAILURE();
      return true;
    });
  }
}

TEST(StaticIndex, FindsAFewPieces) {
  const StaticIndex index({PieceAt({0, 0, 1, 1}), PieceAt({5, 5, 6, 6}), PieceAt({0.5, 0.5, 5.5, 5.5})});
  EXPECT_EQ(index.bounds(), (Rectangle{0, 0, 6, 6}));
  EXPECT_EQ(Find(index, {0.2, 0.2, 0.3, 0.3}), (std::vector<std::ptrdiff_t>{0}));
  EXPECT_EQ(Find(index, {0.7, 0.7, 0.8, 0.8}), (std::vector<std::ptrdiff_t>{0, 2}));
  EXPECT_EQ(Find(index, {1.0, 0.0, 2.0, 0.1}), (std::vector<std::ptrdiff_t>{0})) << "touching counts";
  EXPECT_EQ(Find(index, {-9, -9, 9, 9}), (std::vector<std::ptrdiff_t>{0, 1, 2}));
  EXPECT_TRUE(Find(index, {7, 0, 8, 1}).empty());
}

TEST(StaticIndex, IsSurelyEmptyOnlyWherePiecesAreNot) {
  std::vector<ConvexPiece> pieces;
  for (std::uint64_t i = 0; i < 40; ++i) {
    const double x = 20.0 * RandomUniform({1, i});
    const double y = 20.0 * RandomUniform({2, i});
    pieces.push_back(PieceAt({x, y, x + RandomUniform({3, i}), y + 0.1}));
  }
  const StaticIndex index(pieces);
  int empty = 0;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    const double x = 24.0 * RandomUniform({4, i}) - 2.0;
    const double y = 24.0 * RandomUniform({5, i}) - 2.0;
    const Rectangle box{x, y, x + 2.0 * RandomUniform({6, i}), y + 2.0 * RandomUniform({7, i})};
    if (!index.IsSurelyEmpty(box)) continue;
    ++empty;
    ASSERT_TRUE(Find(index, box).empty()) << box.min_x << ' ' << box.min_y;
  }
  EXPECT_GT(empty, 1'000);
  EXPECT_FALSE(index.IsSurelyEmpty({-1e6, -1e6, 1e6, 1e6}));
  EXPECT_TRUE(StaticIndex().IsSurelyEmpty({-1e6, -1e6, 1e6, 1e6}));
}

// Numbers of kept pieces that a ray may hit, in the order of its walk.
std::vector<std::uint32_t> Walk(const StaticIndex& index, double y) {
  std::vector<std::uint32_t> walked;
  index.WalkRay({-1.0, y}, {1.0, 0.0}, {1.0, kInfinity}, 100.0, [&](std::span<const std::uint32_t> pieces, double) {
    walked.insert(walked.end(), pieces.begin(), pieces.end());
    return true;
  });
  return walked;
}

std::vector<ConvexPiece> Steps(int count) {
  std::vector<ConvexPiece> pieces;
  for (int i = 0; i < count; ++i) pieces.push_back(PieceAt({2.0 * i, 1.0 * i, 2.0 * i + 1.0, 1.0 * i + 1.0}));
  return pieces;
}

TEST(StaticIndex, EqualPiecesGiveEqualBytesForRays) {
  const StaticIndex index(Steps(50));
  const StaticIndex same(Steps(50));
  const StaticIndex other(Steps(51));
  const auto bytes = index.ray_map().bytes();
  ASSERT_GT(bytes.size(), 50 * sizeof(RayPiece));
  EXPECT_TRUE(std::ranges::equal(bytes, same.ray_map().bytes()));
  EXPECT_FALSE(std::ranges::equal(bytes, other.ray_map().bytes()));
}

TEST(StaticIndex, RaysWalkInMemoryOfOthers) {
  StaticIndex index(Steps(50));
  const StaticIndex before = index;
  ASSERT_EQ(Walk(index, 7.5), Walk(before, 7.5));
  const auto bytes = before.ray_map().bytes();
  struct alignas(64) Line {
    std::byte bytes[64];
  };
  const auto memory = std::make_shared<std::vector<Line>>(bytes.size() / sizeof(Line));
  std::memcpy(memory->data(), bytes.data(), bytes.size());
  const std::weak_ptr<std::vector<Line>> lives = memory;
  index.ShareRayMap(
      [memory](std::span<const std::byte>) { return std::shared_ptr<const std::byte>(memory, memory->data()->bytes); });
  EXPECT_EQ(index.ray_map().bytes().data(), memory->data()->bytes);
  for (const double y : {0.5, 7.5, 49.5, 50.5}) EXPECT_EQ(Walk(index, y), Walk(before, y));
  EXPECT_EQ(Find(index, {-9, -9, 99, 99}).size(), 50u);
  index.ShareRayMap([](std::span<const std::byte>) { return nullptr; });
  EXPECT_EQ(index.ray_map().bytes().data(), memory->data()->bytes) << "nothing better was found";
  index = StaticIndex();
  EXPECT_EQ(lives.use_count(), 1) << "the memory is still held";
}

TEST(StaticIndex, CopesWithManyRectangles) {
  std::vector<ConvexPiece> pieces;
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 500; ++x) pieces.push_back(PieceAt({x * 0.1, y * 0.1, x * 0.1 + 0.05, y * 0.1 + 0.05}));
  }
  const StaticIndex index(std::move(pieces));
  EXPECT_EQ(Find(index, {10.01, 10.01, 10.02, 10.02}), (std::vector<std::ptrdiff_t>{100 * 500 + 100}));
  EXPECT_EQ(Find(index, {0.0, 0.0, 0.31, 0.01}).size(), 4u);
  EXPECT_EQ(Find(index, {-1, -1, 100, 100}).size(), 200'000u);
}

TEST(StaticIndex, CopesWithManyPiecesInOnePlace) {
  std::vector<ConvexPiece> pieces(20'000, PieceAt({0, 0, 10, 10}));
  pieces.push_back(PieceAt({1000, 1000, 1000.1, 1000.1}));
  const StaticIndex index(std::move(pieces));
  EXPECT_EQ(Find(index, {5, 5, 5, 5}).size(), 20'000u);
  EXPECT_EQ(Find(index, {999, 999, 1001, 1001}), (std::vector<std::ptrdiff_t>{20'000}));
}

TEST(StaticIndex, RayWalkVisitsHitPiecesInTime) {
  const StaticIndex index({PieceAt({0, 0, 1, 1}), PieceAt({3, 0, 4, 1}), PieceAt({0, 7, 1, 8})});
  double first_distance = -1.0;
  bool saw_second = false;
  index.WalkRay({-1.0, 0.5}, {1.0, 0.0}, {1.0, kInfinity}, 20.0,
                [&](std::span<const std::uint32_t> pieces, double distance) {
                  for (std::uint32_t piece : pieces) {
                    if (piece == 0 && first_distance < 0.0) first_distance = distance;
                    saw_second |= piece == 1;
                  }
                  return true;
                });
  EXPECT_GE(first_distance, 0.0);
  EXPECT_LE(first_distance, 1.0);
  EXPECT_TRUE(saw_second);
}

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

// '#' for an occupied cell; the first line is the row with the largest y, as on a picture.
std::string Picture(const OccupancyGrid& grid) {
  std::string picture;
  for (std::uint32_t row = grid.height; row-- > 0;) {
    for (std::uint32_t column = 0; column < grid.width; ++column) {
      picture += grid.occupied[row * grid.width + column] ? '#' : '.';
    }
    picture += '\n';
  }
  return picture;
}

TEST(OccupancyGrid, MarksTheCellsThatSomethingCoversAPartOf) {
  SmallWorld world;
  world.AddBox("west", 0.5, 1.5, 1.0, 3.0, {0.0, 1.0});
  world.AddBox("speck", 3.5, 0.5, 0.1, 0.1, {0.0, 1.0});
  world.AddBox("corner", 3.9, 2.9, 0.2, 0.2, {0.0, 1.0});
  const OccupancyGrid grid = MakeOccupancyGrid(Scene(world.world()), 1.0, 0.5);
  EXPECT_EQ(grid.origin_x, 0.0);
  EXPECT_EQ(grid.origin_y, 0.0);
  EXPECT_EQ(Picture(grid),
            "#..#\n"
            "#...\n"
            "#..#\n");
}

TEST(OccupancyGrid, ShowsOneHeight) {
  SmallWorld world;
  world.AddBox("low", 0.5, 0.5, 1.0, 1.0, {0.0, 0.5});
  world.AddBox("high", 1.5, 0.5, 1.0, 1.0, {1.0, 2.0});
  const Scene scene(world.world());
  EXPECT_EQ(Picture(MakeOccupancyGrid(scene, 1.0, 0.25)), "#.\n");
  EXPECT_EQ(Picture(MakeOccupancyGrid(scene, 1.0, 1.5)), ".#\n");
  EXPECT_EQ(Picture(MakeOccupancyGrid(scene, 1.0, 0.75)), "..\n");
}

TEST(OccupancyGrid, ShowsNeitherRobotsNorInvisibleNonObstacles) {
  SmallWorld world;
  world.AddBox("wall", 0.5, 0.5, 1.0, 1.0, {0.0, 1.0});
  ModelDescription& ghost = world.AddBox("ghost", 2.5, 0.5, 1.0, 1.0, {0.0, 1.0});
  ghost.obstacle_return = false;
  ghost.ranger_return = -1.0;
  world.AddRobot("r", {1.5, 0.5, 0.0, 0.0});
  const std::string picture = Picture(MakeOccupancyGrid(Scene(world.world()), 1.0, 0.2));
  EXPECT_EQ(picture.substr(0, 2), "#.");
  EXPECT_EQ(picture.find('#', 1), std::string::npos);
}

TEST(OccupancyGrid, CoversATurnedBoxWithoutGaps) {
  SmallWorld world;
  world.AddBox("box", 0.0, 0.0, 2.0, 2.0, {0.0, 1.0}).X_PM.heading = kPi / 4;
  const OccupancyGrid grid = MakeOccupancyGrid(Scene(world.world()), 0.05, 0.5);
  int occupied = 0;
  for (const bool cell : grid.occupied) occupied += cell;
  EXPECT_GT(occupied * 0.05 * 0.05, 4.0);
  EXPECT_LT(occupied * 0.05 * 0.05, 4.5);  // the rim adds a cell here and there
}

TEST(OccupancyGrid, IsNothingInAnEmptyWorldAndNeverTooLarge) {
  EXPECT_TRUE(MakeOccupancyGrid(Scene(SmallWorld().world()), 0.05, 0.1).empty());
  SmallWorld world;
  world.AddBox("a", -4000.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  world.AddBox("b", 4000.0, 8000.0, 1.0, 1.0, {0.0, 1.0});
  const OccupancyGrid grid = MakeOccupancyGrid(Scene(world.world()), 0.05, 0.1);
  EXPECT_LE(grid.occupied.size(), kMaxGridCells);
  EXPECT_EQ(grid.resolution, 3.2);
}

// A model like a ROS map of 4 x 3 pixels of 0.5 m, with a box of the same size around its origin.
ModelDescription& AddMap(SmallWorld& world, const Pose& X_WM) {
  ModelDescription& map = world.AddBox("map", 0.0, 0.0, 0.5, 0.5, {0.0, 1.0});
  map.X_PM = X_WM;
  map.map = {4, 3, 0.5};
  return map;
}

TEST(OccupancyGrid, KeepsTheExtentOfAMapAndItsResolution) {
  SmallWorld world;
  AddMap(world, {-1.0, 2.0, 0.0, 0.0});
  const OccupancyGrid grid = MakeOccupancyGrid(Scene(world.world()), std::nullopt, 0.5);
  EXPECT_EQ(grid.resolution, 0.5);
  EXPECT_EQ(grid.width, 5u);  // half of the box is beside the map
  EXPECT_EQ(grid.height, 4u);
  EXPECT_EQ(grid.origin_x, -1.5);
  EXPECT_EQ(grid.origin_y, 1.5);
  const OccupancyGrid fine = MakeOccupancyGrid(Scene(world.world()), 0.25, 0.5);
  EXPECT_EQ(fine.width, 9u);
  EXPECT_EQ(fine.origin_x, -1.25);
  EXPECT_EQ(MakeOccupancyGrid(Scene(world.world()), 0.25, 0.5, 20).resolution, 0.5);
}

TEST(OccupancyGrid, SpansATurnedMap) {
  SmallWorld world;
  AddMap(world, {0.0, 0.0, 0.0, kPi / 2});
  const OccupancyGrid grid = MakeOccupancyGrid(Scene(world.world()), 0.5, 0.5);
  EXPECT_NEAR(grid.origin_x, -1.5, 1e-9);
  EXPECT_NEAR(grid.origin_y, -0.25, 1e-9);  // of the box
  EXPECT_EQ(grid.width, 4u);                // 1.75 m
  EXPECT_EQ(grid.height, 5u);               // 2.25 m
}

TEST(UsualMapHeight, IsThatOfTheLowestScanner) {
  SmallWorld world;
  EXPECT_EQ(UsualMapHeight(Scene(world.world())), 0.1);
  const RobotId robot = world.AddRobot("r", {});
  world.AddRanger(robot, {0.0, 0.0, 0.05, 0.0}, {OneRay()});
  world.AddRanger(robot, {0.0, 0.0, 0.5, 0.0}, {Fan(1.0, 5)});
  world.AddRanger(robot, {0.0, 0.0, 0.25, 0.0}, {Fan(1.0, 5)});
  EXPECT_EQ(UsualMapHeight(Scene(world.world())), 0.25);
}

// Cells: 0 1 2 3 in the lowest row, up to 8 9 10 11.
const Grid kGrid({0.0, 0.0, 4.0, 3.0}, 1.0, 100.0);

TEST(Grid, NumbersCellsRowByRow) {
  EXPECT_EQ(kGrid.cell_count(), 12u);
  EXPECT_EQ(kGrid.CellOf({0.5, 0.5}), 0u);
  EXPECT_EQ(kGrid.CellOf({3.5, 0.5}), 3u);
  EXPECT_EQ(kGrid.CellOf({0.5, 2.5}), 8u);
}

TEST(Grid, PointsOutsideBelongToTheNearestCell) {
  EXPECT_EQ(kGrid.CellOf({-1e300, -5.0}), 0u);
  EXPECT_EQ(kGrid.CellOf({1e300, 1e300}), 11u);
  EXPECT_EQ(kGrid.CellOf({1.5, std::numeric_limits<double>::quiet_NaN()}), 1u);
}

TEST(Grid, EnlargesCellsToKeepTheirNumber) {
  const Grid grid({0.0, 0.0, 1e6, 1e6}, 1e-3, 1000.0);
  EXPECT_LE(grid.cell_count(), 1000u);
  EXPECT_GT(grid.cell_count(), 400u);
}

TEST(Grid, EnlargesCellsToKeepALongRowShort) {
  EXPECT_LE(Grid({0.0, 0.0, 1e6, 1.0}, 1.0, 1e9).axis(0).count, 65536);
}

}  // namespace
}  // namespace troupe
