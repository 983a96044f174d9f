// ROS maps.
#include "worldfile/map/map_yaml.h"

#include "tests/worldfile/world_folder.h"
#include "troupe/pose.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const char kYaml[] =
    "image: map.pgm\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

const Shape& ShapeOf(const LoadedWorld& loaded) {
  return loaded.world.shape(loaded.world.models[0].shape);
}

// map.pgm: upper row 0 127 255, lower row 205 0 254.
TEST(MapYaml, IsOneStaticModelWithTheImagesLowerLeftCornerAtTheOrigin) {
  const WorldFolder folder;
  folder.Write("m.yaml", kYaml);
  const LoadedWorld loaded = folder.Load("m.yaml");
  ASSERT_EQ(loaded.world.models.size(), 1u);
  EXPECT_EQ(loaded.world.models[0].name, "map");
  EXPECT_EQ(loaded.world.models[0].X_PM, (Pose{-1, 2, 0, 0}));
  EXPECT_THAT(ShapeOf(loaded).rectangles, ElementsAre(Rectangle{0.5, 0, 1, 0.5}, Rectangle{0, 0.5, 0.5, 1}));
  EXPECT_EQ(ShapeOf(loaded).rectangles_z, (ZRange{0.0, 2.0}));
  EXPECT_EQ(loaded.map_width, 3);
  EXPECT_THAT(loaded.files, ElementsAre(folder.Path("m.yaml"), folder.Path("map.pgm")));
  EXPECT_THAT(loaded.warnings, IsEmpty());
}

TEST(MapYaml, ThresholdIsAProbability) {
  const WorldFolder folder;
  folder.Write("m.yaml", std::string(kYaml) + "mode: scale\nwall_height: 1\nfrobnicate: 3\n");
  LoadedWorld loaded = folder.Load("m.yaml");
  EXPECT_EQ(ShapeOf(loaded).rectangles.size(), 2u);
  EXPECT_EQ(ShapeOf(loaded).rectangles_z, (ZRange{0.0, 1.0}));
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_EQ(loaded.warnings[0].message, "key 'frobnicate' has no effect");
  EXPECT_EQ(loaded.warnings[0].where.line, 9);

  std::string yaml = kYaml;
  yaml.replace(yaml.find("0.65"), 4, "0.50");  // 127 is a probability of 0.502
  folder.Write("m.yaml", yaml);
  loaded = folder.Load("m.yaml");
  EXPECT_THAT(ShapeOf(loaded).rectangles, ElementsAre(Rectangle{0.5, 0, 1, 0.5}, Rectangle{0, 0.5, 1, 1}));
}

TEST(MapYaml, NegateTurnsBlackAndWhiteRound) {
  const WorldFolder folder;
  std::string yaml = kYaml;
  yaml.replace(yaml.find("negate: 0"), 9, "negate: 1");
  folder.Write("m.yaml", yaml);
  EXPECT_THAT(ShapeOf(folder.Load("m.yaml")).rectangles,
              ElementsAre(Rectangle{0, 0, 0.5, 0.5}, Rectangle{1, 0, 1.5, 1}));
}

TEST(MapYaml, RawValuesArePercentAndAbove100Unknown) {
  const WorldFolder folder;
  folder.Write("map.pgm", "P2 4 1 255\n0 64 65 100\n");
  folder.Write("m.yaml", std::string(kYaml) + "mode: raw\n");
  EXPECT_THAT(ShapeOf(folder.Load("m.yaml")).rectangles, ElementsAre(Rectangle{1, 0, 2, 0.5}));
}

TEST(MapYaml, OriginMayBeTurned) {
  const WorldFolder folder;
  std::string yaml = kYaml;
  yaml.replace(yaml.find("2.0, 0.0"), 8, "2.0, 0.5");
  folder.Write("m.yaml", yaml);
  EXPECT_EQ(folder.Load("m.yaml").world.models[0].X_PM, (Pose{-1, 2, 0, 0.5}));
}

TEST(MapYaml, MayBeNamedInAWorldFile) {
  const WorldFolder folder;
  folder.Write("maps/m.yaml", kYaml);
  folder.Write("maps/map.pgm", "P2 1 1 255\n0\n");
  const LoadedWorld loaded = folder.LoadText("model( map_yaml \"maps/m.yaml\" )\nposition( )\n");
  EXPECT_EQ(loaded.world.models[0].X_PM, (Pose{-1, 2, 0, 0}));
  EXPECT_THAT(ShapeOf(loaded).rectangles, ElementsAre(Rectangle{0, 0, 0.5, 0.5}));
  EXPECT_EQ(loaded.world.robots.size(), 1u);
}

}  // namespace
}  // namespace troupe
