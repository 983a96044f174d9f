#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>

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

TEST(ExportMap, RefusesAWorldWithoutStaticBodies) {
  test::TemporaryFolder folder;
  std::ofstream(folder.Path("a.world")) << "position ( name \"r\" )\n";
  EXPECT_EQ(Export({"export-map", folder.Path("a.world"), "-o", folder.Path("map")}), 2);
  EXPECT_EQ(Export({"export-map", folder.Path("no.world"), "-o", folder.Path("map")}), 2);
}

}  // namespace
}  // namespace troupe
