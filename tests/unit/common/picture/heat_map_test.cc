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

// The time of one robot at (x, y) for a number of ticks of 0.1 s.
HeatMap OfOneRobot(double x, double y, int ticks, double cell = 0.5) {
  SmallWorld world;
  world.AddRobot("a", {x, y, 0.0, 0.0});
  const WorldState state = PlacedState(world.world());
  HeatMap heat(HeatKind::kRobots, cell);
  for (int i = 0; i < ticks; ++i) heat.Add(world.world(), state);
  return heat;
}

TEST(HeatMapTest, IsASumOfMapsInAnyOrder) {
  const std::vector<HeatMap> parts = {OfOneRobot(0.0, 0.0, 3), OfOneRobot(0.1, -0.1, 4), OfOneRobot(-2.0, 1.0, 1)};
  HeatMap sum(HeatKind::kRobots, 0.5);
  for (const HeatMap& part : parts) sum.Add(part);
  HeatMap reversed(HeatKind::kRobots, 0.5);
  for (std::size_t i = parts.size(); i-- > 0;) reversed.Add(parts[i]);
  EXPECT_EQ(sum, reversed);
  EXPECT_THAT(CellsOf(sum), ElementsAre(std::tuple(-2.25, 0.75, 0.1), std::tuple(-0.25, -0.25, 7 * 0.1)));
  sum.Add(HeatMap(HeatKind::kRobots, 0.5));
  EXPECT_EQ(sum, reversed) << "of a run without a tick";
}

TEST(HeatMapTest, AddsRunsWithTicksOfOtherLengths) {
  SmallWorld world;
  world.AddRobot("a", {0.0, 0.0, 0.0, 0.0});
  WorldDescription slow = world.world();
  slow.interval_ns = 40'000'000;
  const WorldState state = PlacedState(slow);
  HeatMap other(HeatKind::kRobots, 0.5);
  for (int i = 0; i < 5; ++i) other.Add(slow, state);
  HeatMap sum = OfOneRobot(0.0, 0.0, 3);
  sum.Add(other);
  EXPECT_EQ(sum.times().unit, 20'000'000);
  EXPECT_DOUBLE_EQ(sum.most(), 0.5);
  other.Add(OfOneRobot(0.0, 0.0, 3));
  EXPECT_EQ(sum, other);
}

// A map of one tick in each of these cells.
HeatMap OfCells(std::int64_t begin, std::int64_t end) {
  HeatMap::Times times{0, 100'000'000, {}};
  for (std::int64_t i = begin; i < end; ++i) times.cells[{i, -i / 2}] = 1;
  return test::ValueOf(HeatMap::Of(HeatKind::kRobots, 0.5, std::move(times)));
}

TEST(HeatMapTest, JoinsCellsBeyondItsBoundWhateverTheOrder) {
  const auto most = static_cast<std::int64_t>(HeatMap::kMaxCells);
  const HeatMap first = OfCells(-most / 2, most / 2);
  EXPECT_DOUBLE_EQ(first.cell(), 0.5);
  const std::vector<HeatMap> parts = {first, OfCells(most / 2, most / 2 + 1), OfOneRobot(0.2, 0.3, 2)};
  HeatMap sum(HeatKind::kRobots, 0.5);
  for (const HeatMap& part : parts) sum.Add(part);
  HeatMap reversed(HeatKind::kRobots, 0.5);
  for (std::size_t i = parts.size(); i-- > 0;) reversed.Add(parts[i]);
  EXPECT_EQ(sum, reversed);
  EXPECT_DOUBLE_EQ(sum.cell(), 1.5);
  EXPECT_LE(sum.times().cells.size(), HeatMap::kMaxCells);
  std::uint64_t ticks = 0;
  for (const auto& [place, time] : sum.times().cells) ticks += time;
  EXPECT_EQ(ticks, HeatMap::kMaxCells + 3);
  // The origin is still the middle of a cell, and a tick comes into the cell in which its place was before.
  EXPECT_EQ(sum.times().cells.at({0, 0}), 3U + 2U);
  HeatMap later = sum;
  later.Add(OfOneRobot(-0.74, 0.74, 1));
  EXPECT_EQ(later.times().cells.at({0, 0}), 6U);
  SmallWorld world;
  world.AddRobot("a", {-0.74, 0.74, 0.0, 0.0});
  sum.Add(world.world(), PlacedState(world.world()));
  EXPECT_EQ(sum, later);
}

TEST(HeatMapTest, RefusesTimesThatNoMapHas) {
  const auto refused = [](double cell, HeatMap::Times times) {
    return !HeatMap::Of(HeatKind::kRobots, cell, std::move(times)).ok();
  };
  EXPECT_FALSE(refused(0.5, {}));
  EXPECT_TRUE(refused(0.0, {}));
  EXPECT_TRUE(refused(0.5, {.joined = -1}));
  EXPECT_TRUE(refused(0.5, {.joined = 1000}));
  EXPECT_TRUE(refused(0.5, {.unit = -1}));
  EXPECT_TRUE(refused(0.5, {.cells = {{{0, 0}, 1}}})) << "without a unit";
  EXPECT_TRUE(refused(0.5, {.unit = 1, .cells = {{{0, 0}, 0}}}));
  EXPECT_TRUE(refused(0.5, {.unit = 1, .cells = {{{std::int64_t{1} << 60, 0}, 1}}}));
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
  heat.Add(test::ValueOf(HeatMap::Of(HeatKind::kRobots, 0.5, {0, 100'000'000, {{{40, 0}, 5}}})));
  EXPECT_THAT(test::ValueOf(DrawPicture(world.world(), state, {}, options, {}, &heat)), HasSubstr("rgb(94%,42%,18%)"))
      << "where no body is";
  heat.SetRuns(7);
  EXPECT_NE(some, test::ValueOf(DrawPicture(world.world(), state, {}, options, {}, &heat))) << "of 7 runs";
}

}  // namespace
}  // namespace troupe
