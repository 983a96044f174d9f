#include "common/picture/heat_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "common/model/states.h"
#include "common/picture/draw_picture.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// The left and lower side of each cell, and its seconds.
std::vector<std::tuple<double, double, double>> CellsOf(const HeatMap& heat) {
  std::vector<std::tuple<double, double, double>> cells;
  heat.ForEachCell([&](const Rectangle& cell, double seconds) { cells.emplace_back(cell.min_x, cell.min_y, seconds); });
  return cells;
}

TEST(HeatMapTest, AddsUpTheTimeOfRobotsByCell) {
  SmallWorld world;
  world.AddRobot("a", {0.3, 0.2, 0.0, 0.0});
  world.AddRobot("b", {-0.1, 0.6, 3.0, 0.0});
  WorldState state = PlacedState(world.world());
  HeatMap heat(HeatKind::kRobots, 0.5);
  EXPECT_TRUE(heat.empty());
  for (int i = 0; i < 3; ++i) heat.Add(world.world(), state);
  state.robots[0].X_WR.x = 1.2;
  heat.Add(world.world(), state);
  EXPECT_THAT(CellsOf(heat), ElementsAre(std::tuple(-0.25, 0.25, 4 * 0.1), std::tuple(0.25, -0.25, 3 * 0.1),
                                         std::tuple(0.75, -0.25, 0.1)));
  EXPECT_DOUBLE_EQ(heat.most(), 0.4);
  HeatMap ground(HeatKind::kRobots, 0.5);
  ground.SetHeights(-1.0, 2.0);
  ground.Add(world.world(), state);
  EXPECT_EQ(CellsOf(ground).size(), 1u) << "of one level";
}

TEST(HeatMapTest, OfWaitsHasOnlyRobotsThatWait) {
  SmallWorld world;
  world.AddRobot("a", {0.3, 0.2, 0.0, 0.0});
  world.AddRobot("b", {2.0, 0.6, 0.0, 0.0});
  WorldState state = PlacedState(world.world());
  state.waits = {{.robot = RobotId(1)}};
  HeatMap heat(HeatKind::kWaits, 1.0);
  heat.Add(world.world(), state);
  EXPECT_THAT(CellsOf(heat), ElementsAre(std::tuple(1.5, 0.5, 0.1)));
}

TEST(HeatMapTest, IsDrawnUnderTheBodiesWithALegend) {
  SmallWorld world;
  world.AddRobot("a", {0.3, 0.2, 0.0, 0.0});
  const WorldState state = PlacedState(world.world());
  HeatMap heat(HeatKind::kRobots, 0.5);
  PictureOptions options;
  options.format = PictureFormat::kSvg;
  const std::string none = test::ValueOf(DrawPicture(world.world(), state, {}, options, {}, &heat));
  for (int i = 0; i < 20; ++i) heat.Add(world.world(), state);
  const std::string some = test::ValueOf(DrawPicture(world.world(), state, {}, options, {}, &heat));
  const std::string without = test::ValueOf(DrawPicture(world.world(), state, {}, options));
  EXPECT_NE(some, none);
  EXPECT_GT(some.size(), without.size());
  // The dark red of the cell with the most time.
  EXPECT_THAT(some, HasSubstr("rgb(40%,0%,13%)"));
  EXPECT_EQ(some, test::ValueOf(DrawPicture(world.world(), state, {}, options, {}, &heat))) << "the same bytes";
}

}  // namespace
}  // namespace troupe
