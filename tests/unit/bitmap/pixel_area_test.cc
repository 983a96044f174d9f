#include "troupe/pixel_area.h"

#include <gtest/gtest.h>

#include <limits>

namespace troupe {
namespace {

std::shared_ptr<const DenseCover> Checkerboard(int width, int height) {
  Bitmap bitmap(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) bitmap.set_occupied(x, y, (x + y) % 2 == 0);
  }
  return std::make_shared<const DenseCover>(std::move(bitmap));
}

TEST(PixelArea, PlacesLinesByTheStepsOfTheImport) {
  const PixelArea area = PixelArea(Checkerboard(7, 5), {}, {})
                             .Stretched({3.5, 2.5}, {0.3 / 7.0, 0.2 / 5.0})
                             .Stretched({0.01, 0.0}, {0.9, 1.1})
                             .Moved({0.1, 0.2, 0.0, 0.0});
  EXPECT_EQ(area.x()(3), ((3.0 - 3.5) * (0.3 / 7.0) - 0.01) * 0.9 + 0.1);
  EXPECT_EQ(area.y()(5), (5.0 - 2.5) * (0.2 / 5.0) * 1.1 + 0.2);
  EXPECT_TRUE(area.Check().ok());
}

TEST(PixelArea, FindsThePixelsOfABox) {
  const PixelLines lines{.factor = 0.05};
  const PixelArea area(Checkerboard(10, 8), lines, lines);
  EXPECT_EQ(area.PixelsIn({0.12, 0.21, 0.13, 0.29}), (PixelRectangle{2, 4, 3, 6}));
  EXPECT_EQ(area.PixelsIn({-1.0, -1.0, 1.0, 1.0}), (PixelRectangle{0, 0, 10, 8}));
  const PixelRectangle beyond = area.PixelsIn({2.0, 2.0, 3.0, 3.0});
  EXPECT_EQ(beyond.x0, beyond.x1);
  // A touch at a line counts.
  EXPECT_EQ(area.PixelsIn({0.1, 0.1, 0.1, 0.1}), (PixelRectangle{1, 1, 3, 3}));
}

TEST(PixelArea, IsEqualByItsPixelsAndLines) {
  const PixelLines lines{.factor = 0.05};
  const PixelArea area(Checkerboard(10, 8), lines, lines);
  EXPECT_EQ(area, PixelArea(Checkerboard(10, 8), lines, lines));
  EXPECT_NE(area, PixelArea(Checkerboard(10, 7), lines, lines));
  EXPECT_NE(area, PixelArea(Checkerboard(10, 8), lines, {.factor = 0.06}));
  EXPECT_NE(area, area.Moved({0.0, 0.0, 0.0, 1.0}));
}

TEST(PixelArea, ChecksItsNumbers) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](const PixelLines& x, const Pose& X_MA = {}) {
    return PixelArea(Checkerboard(10, 8), x, {.factor = 0.05}, X_MA).Check().ok();
  };
  EXPECT_TRUE(with({.factor = 0.05}));
  EXPECT_FALSE(with({.factor = 0.0}));
  EXPECT_FALSE(with({.factor = -0.05}));
  EXPECT_FALSE(with({.factor = kNan}));
  EXPECT_FALSE(with({.factor = 1e-7})) << "a pixel too small to be found by arithmetic";
  EXPECT_FALSE(with({.factor = 1e6}));
  EXPECT_FALSE(with({.center = kNan}));
  EXPECT_FALSE(with({.second_center = 1e7}));
  EXPECT_FALSE(with({.second_factor = 1e7}));
  EXPECT_FALSE(with({.shift = 1e7}));
  EXPECT_FALSE(with({.factor = 0.05}, {1e7, 0.0, 0.0, 1.0}));
  EXPECT_FALSE(with({.factor = 0.05}, {0.0, 0.0, 0.0, kNan}));
  EXPECT_FALSE(PixelArea(std::make_shared<const DenseCover>(Bitmap(3, 3)), {}, {}).Check().ok());
}

}  // namespace
}  // namespace troupe
