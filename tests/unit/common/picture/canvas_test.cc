#include "common/picture/canvas.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/text.h"
#include "common/picture/labels.h"
#include "common/picture/rectangle_outline.h"
#include "common/picture/viewport.h"
#include "troupe/random.h"

namespace troupe {
namespace {

TEST(ClipPolygon, KeepsTheInside) {
  const Rectangle box{0, 0, 10, 10};
  const Polygon inside{{1, 1}, {5, 1}, {5, 5}};
  EXPECT_EQ(ClipPolygon(inside, box), inside);
  EXPECT_TRUE(ClipPolygon({{20, 20}, {30, 20}, {30, 30}}, box).empty());
  const Polygon cut = ClipPolygon({{-1e12, 2}, {1e12, 2}, {1e12, 8}, {-1e12, 8}}, box);
  EXPECT_EQ(BoundingBox(cut), (Rectangle{0, 2, 10, 8}));
}

TEST(Canvas, ShortensTextAtWholeLetters) {
  Canvas canvas(PictureFormat::kPng, 100, 100);
  const TextStyle style{10.0, {}};
  EXPECT_EQ(canvas.Shortened("short", 1000.0, style), "short");
  const std::string text = "\u00e4\u00f6\u00fc\u00e4\u00f6\u00fc\u00e4\u00f6\u00fc\u00e4\u00f6\u00fc";
  for (double width = 0.0; width < 120.0; width += 1.0) {
    const std::string shown = canvas.Shortened(text, width, style);
    EXPECT_TRUE(IsPlainLine(shown));
    EXPECT_TRUE(shown.empty() || canvas.TextWidth(shown, style) <= width);
  }
  EXPECT_LT(canvas.Shortened(std::string(1'000'000, 'x'), 50.0, style).size(), 20u);
}

TEST(Canvas, ReportsFailuresOfTheLibrary) {
  Canvas canvas(PictureFormat::kPng, 100'000, 100'000);
  canvas.Fill(Rectangle{0, 0, 10, 10}, {});
  EXPECT_FALSE(canvas.Finish().ok());
}

const Rectangle kPage{0, 0, 400, 300};

double TextWidth(const std::string& text, double size) {
  return 0.6 * size * double(text.size());
}

LabelPlan Place(const std::vector<LabelRequest>& requests, const std::vector<Rectangle>& walls = {}) {
  return PlaceLabels(requests, walls, kPage, {12.0, 8.0}, TextWidth);
}

TEST(Labels, ALoneLabelIsToTheRightAtFullSize) {
  const LabelPlan plan = Place({{"r0", {100, 100, 120, 120}}});
  ASSERT_EQ(plan.labels.size(), 1u);
  EXPECT_EQ(plan.size, 12.0);
  EXPECT_GT(plan.labels[0].box.min_x, 120.0);
}

TEST(Labels, StaysOnThePage) {
  const LabelPlan plan = Place({{"a long name", {380, 100, 398, 118}}});
  ASSERT_EQ(plan.labels.size(), 1u);
  EXPECT_LT(plan.labels[0].box.max_x, 380.0);
}

TEST(Labels, AvoidsWallsWherePossible) {
  const Rectangle wall{121, 0, 400, 300};
  const LabelPlan plan = Place({{"r0", {100, 100, 120, 120}}}, {wall});
  ASSERT_EQ(plan.labels.size(), 1u);
  EXPECT_FALSE(plan.labels[0].box.Overlaps(wall));
  EXPECT_EQ(Place({{"r0", {100, 100, 120, 120}}}, {kPage}).labels.size(), 1u);
}

TEST(Labels, CoverNeitherSolidsNorEachOther) {
  std::vector<LabelRequest> requests;
  for (int i = 0; i < 40; ++i) {
    const double x = 20.0 + (i % 8) * 45.0, y = 20.0 + (i / 8) * 50.0;
    requests.push_back({"r" + std::to_string(i), {x, y, x + 20.0, y + 20.0}});
  }
  const LabelPlan plan = Place(requests);
  EXPECT_EQ(plan.labels.size(), requests.size());
  for (std::size_t i = 0; i < plan.labels.size(); ++i) {
    for (const LabelRequest& request : requests) EXPECT_FALSE(plan.labels[i].box.Overlaps(request.box));
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(plan.labels[i].box.Overlaps(plan.labels[j].box));
  }
}

TEST(Labels, ACrowdGetsSmallerLabelsAndADenseCrowdNone) {
  std::vector<LabelRequest> rows;
  for (int i = 0; i < 12; ++i) rows.push_back({"robot", {100, 50.0 + i * 5.0, 300, 54.0 + i * 5.0}});
  EXPECT_EQ(Place(rows).size, 8.0);
  const std::vector<LabelRequest> heap(500, LabelRequest{"robot", {100, 100, 110, 110}});
  EXPECT_TRUE(Place(heap).labels.empty());
}

// Crossings of a ray to the right: odd means inside.
bool InsideOddNumberOfLoops(const std::vector<Polygon>& loops, const Vec2& p) {
  bool inside = false;
  for (const Polygon& loop : loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2& a = loop[i];
      const Vec2& b = loop[(i + 1) % loop.size()];
      if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
        inside = !inside;
      }
    }
  }
  return inside;
}

TEST(RectangleOutline, NoRectanglesHaveNoOutline) {
  EXPECT_TRUE(OutlineOf({}).empty());
}

TEST(RectangleOutline, AdjoiningRectanglesBecomeOneLoop) {
  const std::vector<Polygon> loops = OutlineOf({{0, 0, 1, 1}, {1, 0, 2, 1}, {0, 1, 2, 3}});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 4u);
}

TEST(RectangleOutline, AHoleIsALoopOfItsOwn) {
  const std::vector<Polygon> loops = OutlineOf({{0, 0, 3, 1}, {0, 1, 1, 2}, {2, 1, 3, 2}, {0, 2, 3, 3}});
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_FALSE(InsideOddNumberOfLoops(loops, {1.5, 1.5}));
  EXPECT_TRUE(InsideOddNumberOfLoops(loops, {0.5, 1.5}));
}

TEST(RectangleOutline, RoundingDoesNotSplitASharedEdge) {
  const double third = 1.0 / 3.0;
  const std::vector<Polygon> loops = OutlineOf({{0, 0, third, 1}, {third + 1e-16, 0, 1, 1}});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 4u);
}

TEST(RectangleOutline, RectanglesWithoutAreaAreLeftOut) {
  EXPECT_TRUE(OutlineOf({{1, 1, 1, 2}}).empty());
}

TEST(RectangleOutline, OutlinesTheAreaOfRandomBitmaps) {
  constexpr int kSize = 12;
  constexpr double kCell = 0.07;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    std::vector<Rectangle> cells;
    std::vector<bool> filled(kSize * kSize);
    for (int i = 0; i < kSize * kSize; ++i) {
      filled[i] = RandomUniform({seed, std::uint64_t(i)}) < 0.5;
      const double x = i % kSize, y = i / kSize;
      if (filled[i]) cells.push_back({x * kCell, y * kCell, (x + 1) * kCell, (y + 1) * kCell});
    }
    const std::vector<Polygon> loops = OutlineOf(cells);
    for (int i = 0; i < kSize * kSize; ++i) {
      const Vec2 middle((i % kSize + 0.5) * kCell, (i / kSize + 0.5) * kCell);
      ASSERT_EQ(InsideOddNumberOfLoops(loops, middle), filled[i]) << "seed " << seed << " cell " << i;
    }
  }
}

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
