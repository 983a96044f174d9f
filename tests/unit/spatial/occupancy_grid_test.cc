#include "common/spatial/occupancy_grid.h"

#include <gtest/gtest.h>

#include "tests/support/small_world.h"

namespace troupe {
namespace {

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

}  // namespace
}  // namespace troupe
