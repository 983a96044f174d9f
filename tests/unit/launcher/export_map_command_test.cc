#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <sstream>

#include "common/spatial/occupancy_grid.h"
#include "launcher/commands/commands.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

int Export(std::vector<std::string> words) {
  CLI::App app;
  int exit_status = -1;
  AddExportMapCommand(app, exit_status);
  std::reverse(words.begin(), words.end());
  app.parse(words);
  return exit_status;
}

// The written map, loaded as a world, gives the same map again.
TEST(ExportMap, WritesAMapThatGivesTheSameMapWhenItIsRead) {
  test::TemporaryFolder folder;
  std::ofstream(folder.Path("a.world")) << "model ( name \"l\" pose [ 1 0.5 0 0 ] size [ 2 1 1 ] )\n"
                                           "model ( name \"r\" pose [ 3.5 2.75 0 0 ] size [ 1 0.5 1 ] )\n";
  ASSERT_EQ(Export({"export-map", folder.Path("a.world"), "-o", folder.Path("map"), "--resolution", "0.25"}), 0);
  const LoadedWorld read = test::ValueOf(LoadWorld(folder.Path("map.yaml"), {}));
  const LoadedWorld original = test::ValueOf(LoadWorld(folder.Path("a.world"), {}));
  const OccupancyGrid expected = MakeOccupancyGrid(Scene(original.world), 0.25, 0.1);
  const OccupancyGrid found = MakeOccupancyGrid(Scene(read.world), 0.25, 0.1);
  EXPECT_EQ(found.width, expected.width);
  EXPECT_EQ(found.height, expected.height);
  EXPECT_NEAR(found.origin_x, expected.origin_x, 1e-9);
  EXPECT_NEAR(found.origin_y, expected.origin_y, 1e-9);
  EXPECT_EQ(found.occupied, expected.occupied);
}

void WriteMap(const test::TemporaryFolder& folder, const std::string& pixels, const std::string& more = "") {
  std::ofstream(folder.Path("in.pgm")) << "P2 4 3 255\n" << pixels;
  std::ofstream(folder.Path("in.yaml")) << "image: in.pgm\nresolution: 0.25\norigin: [-1.0, 2.5, 0]\nnegate: 0\n"
                                           "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
                                        << more;
}

TEST(ExportMap, KeepsSizeOriginResolutionAndPixelsOfAMap) {
  const test::TemporaryFolder folder;
  WriteMap(folder, "254 254 254 254  254 0 254 254  254 254 0 254\n");
  ASSERT_EQ(Export({"export-map", folder.Path("in.yaml"), "-o", folder.Path("out")}), 0);
  std::stringstream yaml;
  yaml << std::ifstream(folder.Path("out.yaml")).rdbuf();
  EXPECT_THAT(yaml.str(), testing::HasSubstr("resolution: 0.25\norigin: [-1, 2.5, 0]\n"));
  std::stringstream image;
  image << std::ifstream(folder.Path("out.pgm")).rdbuf();
  const std::string light(1, '\xfe');
  const std::string row = light + light + light + light;
  EXPECT_EQ(image.str(), "P5\n4 3\n255\n" + row + light + std::string(1, '\0') + light + light + light + light +
                             std::string(1, '\0') + light);
}

TEST(ExportMap, WritesAMapWithoutAnOccupiedCell) {
  const test::TemporaryFolder folder;
  WriteMap(folder, "254 254 254 254  254 254 254 254  254 205 205 254\n");
  ASSERT_EQ(Export({"export-map", folder.Path("in.yaml"), "-o", folder.Path("out"), "--resolution", "0.1"}), 0);
  const Result<LoadedWorld> read = LoadWorld(folder.Path("out.yaml"), {});
  ASSERT_TRUE(read.ok()) << read.error().ToString();
  EXPECT_EQ(read.value().map_width, 10);
  EXPECT_EQ(read.value().map_height, 8);
}

TEST(ExportMap, EnlargesAMapByWholeCellsForBodiesBesideIt) {
  const test::TemporaryFolder folder;
  WriteMap(folder, "254 254 254 254  254 254 254 254  254 254 254 254\n");
  std::ofstream(folder.Path("a.world"))
      << "model( map_yaml \"in.yaml\" )\nmodel( pose [-1.6 3 0 0] size [0.1 0.1 1] )\n";
  ASSERT_EQ(Export({"export-map", folder.Path("a.world"), "-o", folder.Path("out")}), 0);
  const Result<LoadedWorld> read = LoadWorld(folder.Path("out.yaml"), {});
  ASSERT_TRUE(read.ok()) << read.error().ToString();
  EXPECT_EQ(read.value().map_width, 7);  // from -1.75, a whole number of cells before -1, to 0
  EXPECT_EQ(read.value().map_height, 3);
  EXPECT_EQ(read.value().world.models[0].X_PM, (Pose{-1.75, 2.5, 0, 0}));
}

TEST(ExportMap, RefusesAWorldWithoutStaticBodies) {
  test::TemporaryFolder folder;
  std::ofstream(folder.Path("a.world")) << "position ( name \"r\" )\n";
  EXPECT_EQ(Export({"export-map", folder.Path("a.world"), "-o", folder.Path("map")}), 2);
  EXPECT_EQ(Export({"export-map", folder.Path("no.world"), "-o", folder.Path("map")}), 2);
}

}  // namespace
}  // namespace troupe
