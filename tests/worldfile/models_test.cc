// The descriptions of models: bodies, sizes, places, names, colours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/model/states.h"
#include "tests/worldfile/world_folder.h"
#include "troupe/pose.h"
#include "troupe/rectangle_cover.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/models/properties/model_shape.h"

namespace troupe {
namespace {

using testing::ElementsAre;

const ModelDescription& ModelCalled(const LoadedWorld& loaded, const std::string& name) {
  for (const ModelDescription& model : loaded.world.models) {
    if (model.name == name) return model;
  }
  ADD_FAILURE() << "no model " << name;
  return loaded.world.models.front();
}

const Shape& ShapeOf(const LoadedWorld& loaded, std::size_t model) {
  return loaded.world.shape(loaded.world.models[model].shape);
}

Rectangle BoundsOf(const Shape& shape) {
  Rectangle bounds = Rectangle::Nothing();
  for (const Block& block : shape.blocks) bounds.Extend(BoundingBox(block.outline));
  for (const Rectangle& rectangle : shape.rectangles) bounds.Extend(rectangle);
  return bounds;
}

void ExpectNear(const Rectangle& actual, const Rectangle& expected) {
  EXPECT_NEAR(actual.min_x, expected.min_x, 1e-12);
  EXPECT_NEAR(actual.min_y, expected.min_y, 1e-12);
  EXPECT_NEAR(actual.max_x, expected.max_x, 1e-12);
  EXPECT_NEAR(actual.max_y, expected.max_y, 1e-12);
}

std::vector<std::string> Names(const LoadedWorld& loaded) {
  std::vector<std::string> names;
  for (const ModelDescription& model : loaded.world.models) names.push_back(model.name);
  return names;
}

// A triangle of the whole unit square, and a low box in its corner.
const char kTwoBlocks[] =
    "block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0 1] )\n"
    "block( points 4 point[0] [0 0] point[1] [0.5 0] point[2] [0.5 0.5] point[3] [0 0.5] z [0 0.25] )\n";

TEST(Models, DefaultBodyIsABoxOfTheDefaultSize) {
  const LoadedWorld loaded = WorldFolder().LoadText("model( )");
  ASSERT_EQ(ShapeOf(loaded, 0).blocks.size(), 1u);
  EXPECT_EQ(BoundsOf(ShapeOf(loaded, 0)), (Rectangle{-0.2, -0.2, 0.2, 0.2}));
  EXPECT_EQ(ShapeOf(loaded, 0).blocks[0].z, (ZRange{0.0, 1.0}));
  EXPECT_EQ(loaded.world.models[0].color, (Color{1.0, 0.0, 0.0, 1.0}));
  EXPECT_TRUE(loaded.world.models[0].obstacle_return);
  EXPECT_EQ(loaded.world.models[0].ranger_return, 1.0);
}

TEST(Models, NoblocksDropsTheBox) {
  EXPECT_TRUE(ShapeOf(WorldFolder().LoadText("model( noblocks 1 )"), 0).blocks.empty());
}

TEST(Models, BlocksAreScaledTogetherAndCentred) {
  const LoadedWorld loaded = WorldFolder().LoadText("model( size [2 4 3]\n" + std::string(kTwoBlocks) + ")");
  const Shape& shape = ShapeOf(loaded, 0);
  ASSERT_EQ(shape.blocks.size(), 2u);
  ExpectNear(BoundsOf(shape), {-1, -2, 1, 2});
  ExpectNear(BoundingBox(shape.blocks[1].outline), {-1, -2, 0, 0});
  EXPECT_EQ(shape.blocks[0].z, (ZRange{0.0, 3.0}));
  EXPECT_EQ(shape.blocks[1].z, (ZRange{0.0, 0.75}));
}

TEST(Models, HeightsAreScaledButNotShifted) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "model( size [1 1 0.5] block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0.5 1.0] ) )");
  EXPECT_EQ(ShapeOf(loaded, 0).blocks[0].z, (ZRange{0.5, 1.0}));
}

TEST(Models, OutlinesTurnCounterClockwise) {
  const LoadedWorld loaded =
      WorldFolder().LoadText("model( block( points 3 point[0] [0 0] point[1] [0 1] point[2] [1 0] z [0 1] ) )");
  EXPECT_GT(SignedArea(ShapeOf(loaded, 0).blocks[0].outline), 0.0);
}

TEST(Models, BlockWithoutHeightShapesTheOthersButIsLeftOut) {
  const WorldFolder folder;
  const std::string text =
      "model( size [4 4 1]\n"
      "block( points 4 point[0] [0 0] point[1] [2 0] point[2] [2 2] point[3] [0 2] )\n"
      "block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0 1] ) )";
  const LoadedWorld loaded = folder.LoadText(text);
  ASSERT_EQ(ShapeOf(loaded, 0).blocks.size(), 1u);
  ExpectNear(BoundsOf(ShapeOf(loaded, 0)), {-2, -2, 0, 0});
  EXPECT_THAT(
      folder.WarningsOf(text),
      ElementsAre(
          "w.world:2:1: warning: this block has no height (its 'z' is missing or empty), so nothing can touch it"));
}

TEST(Models, WithoutHeightABodyIsFlat) {
  const WorldFolder folder;
  folder.Write("walls.pgm", std::string("P5 2 2 255\n\0\377\0\0", 15));
  const std::string text =
      "model( name \"plan\" bitmap \"walls.pgm\" size [6 5 0] )\n"
      "model( name \"plate\" size [9 9 0] pose [0 0 0.1 0] )\n"
      "position( name \"r\" size [0.4 0.4 0] pose [5 0 0 0] )";
  const LoadedWorld loaded = folder.LoadText(text);
  EXPECT_TRUE(Validate(loaded.world).ok());
  EXPECT_EQ(ShapeOf(loaded, 0).rectangles_z, (ZRange{0.0, 1e-6}));
  EXPECT_TRUE(loaded.world.models[0].obstacle_return);
  ASSERT_EQ(ShapeOf(loaded, 1).blocks.size(), 1u);
  EXPECT_EQ(ShapeOf(loaded, 1).blocks[0].z, (ZRange{0.0, 1e-6}));
  EXPECT_FALSE(loaded.world.models[1].obstacle_return);
  EXPECT_TRUE(loaded.world.models[2].obstacle_return);
  EXPECT_THAT(
      folder.WarningsOf(text),
      ElementsAre(
          "w.world:1:44: warning: 'plan' has no height: it is drawn flat, hit by bodies at its height, and seen "
          "only by rays at its height",
          "w.world:2:26: warning: 'plate' has no height: it is drawn flat, hit by no body, and seen only by rays "
          "at its height",
          "w.world:3:25: warning: 'r' has no height: it is drawn flat, hit by bodies at its height, and seen "
          "only by rays at its height"));
}

TEST(Models, OriginMovesTheBodyButNotTheChildren) {
  const LoadedWorld loaded =
      WorldFolder().LoadText("model( size [1 1 1] origin [1 0 0.5 90] pose [5 0 0 0] model( ) )");
  ExpectNear(BoundsOf(ShapeOf(loaded, 0)), {0.5, -0.5, 1.5, 0.5});
  EXPECT_EQ(ShapeOf(loaded, 0).blocks[0].z, (ZRange{0.5, 1.5}));
  const std::vector<Pose> poses = ModelPoses(loaded.world, PlacedState(loaded.world));
  EXPECT_EQ(poses[1], (Pose{5, 0, 1, 0}));
}

TEST(Models, ChildrenAreStackedByDefault) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "model( size [1 1 2] pose [1 2 3 90] model( pose [1 0 0.5 0] ) )\nmodel( stack_children 0 size [1 1 2] model( ) "
      ")\n");
  const std::vector<Pose> poses = ModelPoses(loaded.world, PlacedState(loaded.world));
  EXPECT_NEAR(poses[1].x, 1.0, 1e-12);
  EXPECT_NEAR(poses[1].y, 3.0, 1e-12);
  EXPECT_NEAR(poses[1].z, 5.5, 1e-12);
  EXPECT_NEAR(poses[1].heading, 0.5 * kPi, 1e-12);
  EXPECT_EQ(poses[3].z, 0.0);
}

TEST(Models, BoundaryAddsFourWallsToTheBox) {
  const LoadedWorld loaded = WorldFolder().LoadText("model( size [2 2 1] boundary 1 )");
  EXPECT_EQ(ShapeOf(loaded, 0).blocks.size(), 5u);
  ExpectNear(BoundsOf(ShapeOf(loaded, 0)), {-1, -1, 1, 1});
}

TEST(Models, BlocksDiscardTheBoundary) {
  const WorldFolder folder;
  const std::string text = "model(\nboundary 1\n" + std::string(kTwoBlocks) + ")";
  EXPECT_EQ(ShapeOf(folder.LoadText(text), 0).blocks.size(), 2u);
  EXPECT_THAT(
      folder.WarningsOf(text),
      ElementsAre(
          "w.world:2:10: warning: property 'boundary' has no effect in a model with blocks and without a bitmap"));
}

// map.pgm: 3 x 2 pixels; occupied are the first two of the upper row, and the middle one of the lower.
TEST(Models, BitmapIsFittedByItsOccupiedPixels) {
  const LoadedWorld loaded = WorldFolder().LoadText("model( size [4 2 0.5] bitmap \"map.pgm\" )");
  EXPECT_THAT(ShapeOf(loaded, 0).rectangles, ElementsAre(Rectangle{0, -1, 2, 0}, Rectangle{-2, 0, 2, 1}));
  EXPECT_EQ(ShapeOf(loaded, 0).rectangles_z, (ZRange{0.0, 0.5}));
  EXPECT_TRUE(ShapeOf(loaded, 0).blocks.empty());
  EXPECT_EQ(loaded.map_width, 3);
  EXPECT_EQ(loaded.map_height, 2);
}

TEST(Models, BoundarySurroundsABitmap) {
  const LoadedWorld loaded = WorldFolder().LoadText("model( size [4 2 0.5] bitmap \"map.pgm\" boundary 1 )");
  EXPECT_EQ(ShapeOf(loaded, 0).rectangles.size(), 2u);
  ASSERT_EQ(ShapeOf(loaded, 0).blocks.size(), 4u);
  ExpectNear(BoundingBox(ShapeOf(loaded, 0).blocks[0].outline), {-2, -1, -1.99, 1});
}

TEST(Models, BlocksAfterABitmapAreRescaledWithIt) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "model( size [4 2 1] bitmap \"map.pgm\" block( points 4 point[0] [2 -1] point[1] [6 -1] point[2] [6 1] "
      "point[3] [2 1] z [0 2] ) )");
  const Shape& shape = ShapeOf(loaded, 0);
  ExpectNear(BoundsOf(shape), {-2, -1, 2, 1});
  ExpectNear(BoundingBox(shape.blocks[0].outline), {0, -1, 2, 1});
  EXPECT_THAT(shape.rectangles, ElementsAre(Rectangle{-1, -1, 0, 0}, Rectangle{-2, 0, 0, 1}));
  EXPECT_EQ(shape.rectangles_z, (ZRange{0.0, 0.5}));
  EXPECT_EQ(shape.blocks[0].z, (ZRange{0.0, 1.0}));
}

TEST(Models, TurnedBitmapBecomesBlocks) {
  const LoadedWorld loaded = WorldFolder().LoadText("model( size [4 2 1] bitmap \"map.pgm\" origin [0 0 0 90] )");
  EXPECT_EQ(ShapeOf(loaded, 0).blocks.size(), 2u);
  EXPECT_TRUE(ShapeOf(loaded, 0).rectangles.empty());
  ExpectNear(BoundsOf(ShapeOf(loaded, 0)), {-1, -2, 1, 2});
}

TEST(Models, BitmapWithoutOccupiedPixelsHasNoBody) {
  const WorldFolder folder;
  folder.Write("white.pgm", "P2 2 1 255 255 255");
  const std::string text = "model( bitmap \"white.pgm\" boundary 1 )";
  EXPECT_TRUE(ShapeOf(folder.LoadText(text), 0).blocks.empty());
  EXPECT_THAT(folder.WarningsOf(text),
              ElementsAre("w.world:1:15: warning: bitmap 'white.pgm' has no occupied pixel, so it has no body"));
}

TEST(Models, ModelsOfOneGeometryShareTheirShape) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "define box model( size [1 1 1] )\nbox( )\nbox( pose [3 0 0 0] color \"blue\" )\nmodel( size [1 1 2] )\n");
  EXPECT_EQ(loaded.world.shapes.size(), 2u);
  EXPECT_EQ(loaded.world.models[0].shape, loaded.world.models[1].shape);
}

TEST(Models, NamesCountTheModelsOfATypeUnderTheirParent) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "define box model( )\nbox( box( ) ranger( ) box( ) )\nposition( )\nbox( name \"b\" model( name \"c\" ) "
      "model( name \"/d\" ) )\nmodel( )\n");
  EXPECT_THAT(Names(loaded), ElementsAre("model:0", "model:0.model:0", "model:0.ranger:0", "model:0.model:1",
                                         "position:0", "b", "b.c", "d", "model:2"));
}

TEST(Models, ColoursHaveNamesOrNumbers) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "model( color \"LightBlue\" )\nmodel( color_rgba [0.1 0.2 0.3 0.4] )\nmodel( color \"random\" )\n"
      "model( color \"random\" )\nmodel( color \"light blue\" )");
  EXPECT_EQ(loaded.world.models[0].color, (Color{173 / 255.0, 216 / 255.0, 230 / 255.0, 1.0}));
  EXPECT_EQ(loaded.world.models[1].color, (Color{0.1, 0.2, 0.3, 0.4}));
  EXPECT_NE(loaded.world.models[2].color, loaded.world.models[3].color);
  EXPECT_EQ(loaded.world.models[4].color, loaded.world.models[0].color);
}

TEST(Models, RandomColoursFollowTheSeed) {
  const WorldFolder folder;
  const auto color = [&](std::uint64_t seed) {
    LoadOverrides overrides;
    overrides.seed = seed;
    return folder.LoadText("model( color \"random\" )", overrides).world.models[0].color;
  };
  EXPECT_EQ(color(5), color(5));
  EXPECT_NE(color(5), color(6));
}

TEST(Models, UnitsOfTheFileApplyToLengthsAndAngles) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "model( size [100 200 50] pose [300 0 0 1] )\nunit_length \"cm\"\nunit_angle \"radians\"\n");
  const ModelDescription& model = loaded.world.models[0];
  EXPECT_EQ(model.size_y, 2.0);
  EXPECT_EQ(model.X_PM, (Pose{3, 0, 0, 1}));
  ExpectNear(BoundsOf(ShapeOf(loaded, 0)), {-0.5, -1, 0.5, 1});
}

TEST(Models, ReturnsAreRead) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "model( obstacle_return 0 ranger_return -1 gripper_return 1 fiducial_return 7 gui_nose 1 )");
  const ModelDescription& model = loaded.world.models[0];
  EXPECT_FALSE(model.obstacle_return);
  EXPECT_EQ(model.ranger_return, -1.0);
  EXPECT_TRUE(model.gripper_return);
  EXPECT_EQ(model.fiducial_return, 7);
  EXPECT_TRUE(model.show_nose);
}

TEST(Models, DevicesOnNoRobotAreBodies) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "gripper( ) fiducial( ) blobfinder( ) bumper( ) actuator( ) camera( ) blinkenlight( ) lightindicator( )");
  EXPECT_EQ(loaded.world.models.size(), 8u);
  EXPECT_EQ(loaded.warnings.size(), 7u);
  EXPECT_EQ(ModelCalled(loaded, "gripper:0").size_y, 0.3);
  EXPECT_TRUE(ShapeOf(loaded, 1).blocks.empty());   // a fiducial finder
  EXPECT_EQ(ShapeOf(loaded, 6).blocks.size(), 1u);  // a light
}

TEST(Models, EnergyIsRead) {
  const auto power_of = [](const std::string& properties) {
    return WorldFolder().LoadText("model( " + properties + " )").world.models.at(0).power;
  };
  EXPECT_EQ(power_of(""), PowerDescription{});
  EXPECT_EQ(power_of("joules 500 watts 3 mass 4 give_watts 5 take_watts 6"),
            (PowerDescription{true, false, 500.0, 500.0, 3.0, 4.0, 5.0, 6.0}));
  EXPECT_EQ(power_of("kjoules 2 kjoules_capacity 5"), (PowerDescription{true, false, 2000.0, 5000.0}));
  EXPECT_EQ(power_of("joules_capacity 70"), (PowerDescription{true, false, 70.0, 70.0}));
  EXPECT_EQ(power_of("joules -1 give_watts 1000"),
            (PowerDescription{.has_store = true, .endless = true, .give_watts = 1000.0}));
  EXPECT_EQ(power_of("watts -1"), PowerDescription{});  // with warnings, as odd_values_test says
  EXPECT_EQ(power_of("joules 1 kjoules 2"), power_of("joules 2000"));
  EXPECT_EQ(power_of("joules_capacity -5").capacity, 0.0);
}

// Bitmaps with too many rectangles for a list, loaded as areas: the same bodies, to the last bit, as lists would be.

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
