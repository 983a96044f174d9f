#include "common/spatial/grid.h"

#include <gtest/gtest.h>

#include <limits>

namespace troupe {
namespace {

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
