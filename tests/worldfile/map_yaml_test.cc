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

// The warnings of the map with `from` replaced by `to`, which has `occupied` rectangles.
void ExpectWarnings(const std::string& from, const std::string& to, const std::vector<std::string>& messages,
                    std::size_t occupied = 2) {
  SCOPED_TRACE(to);
  const WorldFolder folder;
  std::string yaml = kYaml;
  yaml.replace(yaml.find(from), from.size(), to);
  folder.Write("m.yaml", yaml);
  const LoadedWorld loaded = folder.Load("m.yaml");
  std::vector<std::string> found;
  for (const Warning& warning : loaded.warnings) found.push_back(warning.message);
  EXPECT_EQ(found, messages);
  EXPECT_EQ(ShapeOf(loaded).rectangles.size(), occupied);
}

TEST(MapYaml, WhatMapServerReadsLoadsWithAWarning) {
  ExpectWarnings("free_thresh: 0.196", "free_thresh: 0.9",
                 {"found a free_thresh of 0.9 above the occupied_thresh of 0.65, expected at most that; pixels from "
                  "occupied_thresh on are occupied, as in map_server"});
  ExpectWarnings("free_thresh: 0.196\n", "", {"found no key 'free_thresh', expected it; it has no effect here"});
  ExpectWarnings("occupied_thresh: 0.65", "occupied_thresh: 65",
                 {"found 65 for 'occupied_thresh', expected 0 to 1; it is compared as it is"}, 0);
  ExpectWarnings("negate: 0", "negate: 2", {"found '2' for 'negate', expected 0 or 1; 1 is used"});
  ExpectWarnings("negate: 0", "negate: False", {});
  ExpectWarnings("negate: 0", "negate: 0\nimage: other.pgm",
                 {"found key 'image' twice, expected it once; the first one counts"});
  ExpectWarnings("0.0]", "0.0, 0.0]", {"found 4 values for 'origin', expected [x, y, yaw]; the rest is ignored"});
  ExpectWarnings("0.0]", "-nan]", {"found '-nan' for the yaw of 'origin', expected a number; 0 is used"});
  ExpectWarnings("resolution: 0.5", "resolution: +0.5\nmode: Trinary", {});
  ExpectWarnings(
      "image:", "# K\374che\nimage:", {"found a byte that is not UTF-8, expected UTF-8 text; it is left out"});
}

TEST(MapYaml, AnImageOfAnotherMachineIsLookedForBesideTheFile) {
  const WorldFolder folder;
  std::string yaml = kYaml;
  yaml.replace(yaml.find("map.pgm"), 7, "/home/of/another/map.pgm");
  folder.Write("m.yaml", yaml);
  const LoadedWorld loaded = folder.Load("m.yaml");
  EXPECT_EQ(ShapeOf(loaded).rectangles.size(), 2u);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_EQ(
      loaded.warnings[0].message,
      "found no image '/home/of/another/map.pgm'; the one beside this file is used, '" + folder.Path("map.pgm") + "'");
  EXPECT_EQ(loaded.warnings[0].where.line, 1);
  yaml.replace(yaml.find("map.pgm"), 7, "mop.pgm");
  folder.Write("m.yaml", yaml);
  EXPECT_THAT(folder.ErrorOf("m.yaml"), testing::HasSubstr("bitmap '/home/of/another/mop.pgm': cannot read the image"));
}

TEST(MapYaml, KeepsItsGrid) {
  const WorldFolder folder;
  folder.Write("m.yaml", kYaml);
  EXPECT_EQ(folder.Load("m.yaml").world.models[0].map, (MapGrid{3, 2, 0.5}));
  EXPECT_EQ(folder.LoadText("model( map_yaml \"m.yaml\" origin [1 0 0 0] )\nmodel( )").world.models[0].map, MapGrid());
  EXPECT_EQ(folder.LoadText("model( )").world.models[0].map, MapGrid());
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
