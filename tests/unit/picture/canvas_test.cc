#include "common/picture/canvas.h"

#include <gtest/gtest.h>

#include "common/base/text.h"

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

}  // namespace
}  // namespace troupe
