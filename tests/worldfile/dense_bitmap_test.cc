// Bitmaps with too many rectangles for a list, loaded as areas: the same bodies, to the last bit, as lists would be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/worldfile/world_folder.h"
#include "troupe/rectangle_cover.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/models/properties/model_shape.h"

namespace troupe {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 150;
constexpr int kHeight = 110;

// Free at the left and at the bottom, so that the occupied pixels do not fill the image.
bool IsOccupied(int x, int y, int period) {
  return x >= 3 && y >= 2 && (x / period + y) % 2 == 0;
}

std::string Image(int width, int height, int period) {
  std::string bytes = "P5 " + std::to_string(width) + " " + std::to_string(height) + " 255\n";
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x) bytes += IsOccupied(x, y, period) ? '\0' : '\xff';
  }
  return bytes;
}

// The rectangles of the image in pixels, as a body of height 1.
Shape InPixels() {
  Bitmap bitmap(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) bitmap.set_occupied(x, y, IsOccupied(x, y, 1));
  }
  Shape shape;
  for (const PixelRectangle& r : CoverByRectangles(bitmap)) {
    shape.rectangles.push_back({r.x0 + 0.0, r.y0 + 0.0, r.x1 + 0.0, r.y1 + 0.0});
  }
  shape.rectangles_z = {0.0, 1.0};
  return shape;
}

const Shape& BodyOf(const LoadedWorld& loaded, std::size_t model) {
  return loaded.world.shape(loaded.world.models[model].shape);
}

class DenseBitmap : public testing::Test {
 protected:
  DenseBitmap() { folder_.Write("dense.pgm", Image(kWidth, kHeight, 1)); }
  WorldFolder folder_;
};

TEST_F(DenseBitmap, IsAnAreaOfTheSameRectangles) {
  const LoadedWorld loaded = folder_.LoadText("model( size [4 2.1 0.5] bitmap \"dense.pgm\" origin [0.1 0.2 0.3 0] )");
  ASSERT_TRUE(BodyOf(loaded, 0).area);
  EXPECT_TRUE(BodyOf(loaded, 0).rectangles.empty());
  const Shape expected = Moved(ScaledToSize(InPixels(), {4.0, 2.1, 0.5}), {0.1, 0.2, 0.3, 0.0});
  EXPECT_EQ(Listed(BodyOf(loaded, 0)), expected);
  WorldDescription listed = loaded.world;
  listed.shapes[0] = expected;
  EXPECT_EQ(Hash(loaded.world), Hash(listed));
}

TEST_F(DenseBitmap, TurnsAsItsRectanglesDo) {
  const LoadedWorld loaded = folder_.LoadText("model( size [4 2.1 0.5] bitmap \"dense.pgm\" origin [0.1 0.2 0.3 30] )");
  ASSERT_TRUE(BodyOf(loaded, 0).area);
  const Shape expected =
      Moved(ScaledToSize(InPixels(), {4.0, 2.1, 0.5}), {0.1, 0.2, 0.3, BodyOf(loaded, 0).area->X_MA().heading});
  EXPECT_EQ(Listed(BodyOf(loaded, 0)), expected);
}

TEST_F(DenseBitmap, IsRescaledWithBlocks) {
  const LoadedWorld loaded = folder_.LoadText(
      "model( size [4 2 1] bitmap \"dense.pgm\" block( points 4 point[0] [2 -1] point[1] [6 -1] point[2] [6 1] "
      "point[3] [2 1] z [0 2] ) )");
  Shape expected = ScaledToSize(InPixels(), {4.0, 2.0, 1.0});
  expected.blocks.push_back({{{2, -1}, {6, -1}, {6, 1}, {2, 1}}, {0.0, 2.0}});
  expected = Moved(ScaledToSize(std::move(expected), {4.0, 2.0, 1.0}), {});
  ASSERT_TRUE(BodyOf(loaded, 0).area);
  EXPECT_EQ(Listed(BodyOf(loaded, 0)), expected);
}

TEST_F(DenseBitmap, OfARosMapHasItsResolution) {
  folder_.Write("m.yaml",
                "image: dense.pgm\nresolution: 0.07\norigin: [-1, 2, 0]\noccupied_thresh: 0.65\n"
                "free_thresh: 0.25\nnegate: 0\nwall_height: 2\n");
  const LoadedWorld loaded = folder_.Load("m.yaml");
  ASSERT_TRUE(BodyOf(loaded, 0).area);
  Shape expected = InPixels();
  for (Rectangle& r : expected.rectangles) r = {r.min_x * 0.07, r.min_y * 0.07, r.max_x * 0.07, r.max_y * 0.07};
  expected.rectangles_z = {0.0, 2.0};
  EXPECT_EQ(Listed(BodyOf(loaded, 0)), Moved(expected, {}));
}

TEST_F(DenseBitmap, OfABodyThatMovesIsAList) {
  const LoadedWorld loaded = folder_.LoadText(
      "position( size [1 1 1] bitmap \"dense.pgm\" model( size [1 1 1] bitmap \"dense.pgm\" origin [0 0 0 10] ) )\n"
      "model( size [1 1 1] bitmap \"dense.pgm\" gripper_return 1 )\n");
  EXPECT_FALSE(BodyOf(loaded, 0).area);
  EXPECT_EQ(BodyOf(loaded, 0).rectangles, ScaledToSize(InPixels(), {1.0, 1.0, 1.0}).rectangles);
  EXPECT_FALSE(BodyOf(loaded, 1).area);
  EXPECT_EQ(BodyOf(loaded, 1).blocks.size(), InPixels().rectangles.size());
  EXPECT_FALSE(BodyOf(loaded, 2).area);
  EXPECT_TRUE(Validate(loaded.world).ok());
}

TEST_F(DenseBitmap, OfABodyThatMovesIsLimited) {
  folder_.Write("large.pgm", Image(300, 150, 1));
  folder_.Write("w.world", "position( size [1 1 1]\n bitmap \"large.pgm\" )");
  EXPECT_THAT(folder_.ErrorOf("w.world"),
              HasSubstr("w.world:2:9: error: found a bitmap of 21978 rectangles in a model that moves, expected at "
                        "most 16384"));
}

TEST_F(DenseBitmap, IsPlacedByARuleWithinTheSameLimit) {
  folder_.Write("large.pgm", Image(300, 150, 1));
  for (const char* image : {"dense.pgm", "large.pgm"}) {
    folder_.Write("rock.world", "define rock model( size [1 1 1] bitmap \"" + std::string(image) + "\" )\n");
    folder_.Write("s.json",
                  R"({"world": "rock.world", "spawn": [{"model": "rock", "count": 3, "region": [-9, -9, 9, 9]}]})");
    if (std::string(image) == "large.pgm") {
      EXPECT_THAT(folder_.ErrorOf("s.json"), HasSubstr("with a bitmap of 21978 rectangles, expected at most 16384"));
    } else {
      EXPECT_EQ(folder_.Load("s.json").world.models.size(), 3u);
    }
  }
}

TEST_F(DenseBitmap, WithTooSmallPixelsIsRefused) {
  folder_.Write("w.world", "model( size [0.0001 1 1] bitmap \"dense.pgm\" )");
  EXPECT_THAT(folder_.ErrorOf("w.world"), HasSubstr("a pixel of its bitmap has no area"));
}

TEST(BitmapRectangles, ListsFewRectanglesAndKeepsManyAsPixels) {
  Bitmap checkerboard(1000, 1000);
  Bitmap stripes(1000, 1000);
  for (int y = 0; y < 1000; ++y) {
    for (int x = 0; x < 1000; ++x) {
      checkerboard.set_occupied(x, y, (x + y) % 2 == 0);
      stripes.set_occupied(x, y, y % 2 == 0);
    }
  }
  EXPECT_EQ(CoverOf(stripes).rectangles.size(), 500u);
  EXPECT_EQ(CoverOf(stripes).dense, nullptr);
  ASSERT_NE(CoverOf(checkerboard).dense, nullptr);
  EXPECT_EQ(CoverOf(checkerboard).dense->count(), 500'000u);
  EXPECT_TRUE(CoverOf(checkerboard).rectangles.empty());
}

}  // namespace
}  // namespace troupe
