#include "common/picture/viewport.h"

#include <gtest/gtest.h>

#include <cmath>

namespace troupe {
namespace {

TEST(Viewport, RoundsDownToOneTwoOrFive) {
  const struct {
    double value;
    double expected;
  } cases[] = {{1, 1},    {1.99, 1}, {2, 2},     {4.9, 2},     {5, 5},
               {9.99, 5}, {10, 10},  {0.3, 0.2}, {0.07, 0.05}, {34567, 20000}};
  for (const auto& c : cases) EXPECT_NEAR(RoundDown(c.value), c.expected, 1e-12 * c.expected) << c.value;
}

TEST(Viewport, LabelsAreShort) {
  EXPECT_EQ(Label(-0.0), "0");
  EXPECT_EQ(Label(0.5), "0.5");
  EXPECT_EQ(Label(0.1 * 3), "0.3");
  EXPECT_EQ(Label(-12), "-12");
}

TEST(Viewport, ShowsTheWholeWorldUpright) {
  const Rectangle world{-8, -8, 8, 8};
  const Viewport viewport = MakeViewport(world, {});
  const Rectangle page = viewport.ToPage(world);
  EXPECT_GE(page.min_x, viewport.plot.min_x);
  EXPECT_LE(page.max_x, viewport.plot.max_x);
  EXPECT_GE(page.min_y, viewport.plot.min_y);
  EXPECT_LE(page.max_y, viewport.plot.max_y);
  EXPECT_LT(viewport.ToPage(0, 1).y(), viewport.ToPage(0, 0).y());
  EXPECT_NEAR(page.width(), page.height(), 1e-9);
}

TEST(Viewport, ShowsThePartAskedFor) {
  PictureOptions options{.center = Vec2(100, -50), .meters = 4};
  const Viewport viewport = MakeViewport({-8, -8, 8, 8}, options);
  EXPECT_NEAR(viewport.region.width(), 4, 1e-12);
  EXPECT_NEAR(viewport.region.center().x(), 100, 1e-12);
  EXPECT_NEAR(viewport.region.center().y(), -50, 1e-12);
}

TEST(Viewport, PagesOfAnyWorldAreOfBoundedSize) {
  for (PictureView view : {PictureView::kTop, PictureView::kSide}) {
    for (double width : {0.0, 1e-6, 1.0, 1e4, 1e11}) {
      for (double height : {0.0, 1e-6, 1.0, 1e4, 1e11}) {
        PictureOptions options;
        options.view = view;
        const Viewport viewport = MakeViewport({5, 0, 5 + width, height}, options);
        EXPECT_TRUE(std::isfinite(viewport.scale));
        EXPECT_GE(viewport.width, 400);
        EXPECT_LE(viewport.width, 1000);
        EXPECT_GE(viewport.height, 150);
        EXPECT_LE(viewport.height, 1200) << width << " x " << height;
      }
    }
  }
}

TEST(Viewport, ASideViewShowsTheGround) {
  PictureOptions options;
  options.view = PictureView::kSide;
  const Viewport viewport = MakeViewport({-1, 0.5, 1, 0.8}, options);
  EXPECT_LT(viewport.region.min_y, 0.0);
  EXPECT_GT(viewport.region.max_y, 0.8);
}

}  // namespace
}  // namespace troupe
