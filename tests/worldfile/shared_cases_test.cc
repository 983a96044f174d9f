// Small worlds and maps that files of people have led to, beside the checkout. Each has its right result here.
#include <cstdlib>
#include <filesystem>

#include "common/spatial/occupancy_grid.h"
#include "robot-agent/controller/create_controller.h"
#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class SharedCases : public testing::Test {
 protected:
  void SetUp() override {
    const char* const source = std::getenv("TROUPE_SOURCE_DIR");
    folder_ = std::string(source != nullptr ? source : ".") + "/../shared/cases";
    if (!std::filesystem::exists(folder_ + "/fasr2_words.world")) GTEST_SKIP() << "no cases in " << folder_;
  }

  LoadedWorld Load(const std::string& name) const {
    LoadOverrides overrides;
    overrides.check_controller = CheckController;
    return LoadValid(folder_ + "/" + name, overrides);
  }

  static std::vector<std::string> Messages(const LoadedWorld& loaded) {
    std::vector<std::string> messages;
    for (const Warning& warning : loaded.warnings) messages.push_back(warning.message);
    return messages;
  }

  std::string folder_;
};

TEST_F(SharedCases, WordsThatStageIgnoresRefuseNoWorld) {
  const LoadedWorld loaded = Load("fasr2_words.world");
  ASSERT_EQ(loaded.world.robots.size(), 1u);
  EXPECT_EQ(loaded.world.robots[0].controller.name, "fasr2");
  EXPECT_EQ(loaded.world.robots[0].controller.parameters, "{}");
  EXPECT_THAT(Messages(loaded),
              testing::UnorderedElementsAre(HasSubstr("'red'"), HasSubstr("'green'"), HasSubstr("'blue'")));
}

TEST_F(SharedCases, ABmpIsRead) {
  const LoadedWorld loaded = Load("bmp.world");
  EXPECT_EQ(loaded.map_width, 2);
  EXPECT_EQ(loaded.map_height, 2);
  // Black and blue, red and white from the bottom: red is free.
  EXPECT_FALSE(loaded.world.shape(loaded.world.models[0].shape).rectangles.empty());
}

TEST_F(SharedCases, AMapKeepsItsExtent) {
  const Scene scene(Load("map_extent.yaml").world);
  const OccupancyGrid grid = MakeOccupancyGrid(scene, 0.1, UsualMapHeight(scene));
  EXPECT_EQ(grid.width, 12u);
  EXPECT_EQ(grid.height, 10u);
  EXPECT_EQ(grid.origin_x, -1.0);
  EXPECT_EQ(grid.origin_y, -2.0);
  EXPECT_EQ(MakeOccupancyGrid(scene, std::nullopt, 0.1).resolution, 0.1);
}

TEST_F(SharedCases, CrossedThresholdsAreReadAsInMapServer) {
  const LoadedWorld loaded = Load("thresholds_crossed.yaml");
  EXPECT_THAT(Messages(loaded),
              ElementsAre(HasSubstr("found a free_thresh of 0.596 above the occupied_thresh of 0.35")));
  EXPECT_FALSE(loaded.world.shape(loaded.world.models[0].shape).empty());
}

TEST_F(SharedCases, OpacityDoesNotCount) {
  const LoadedWorld loaded = Load("alpha_average.yaml");
  EXPECT_THAT(Messages(loaded), IsEmpty());
  EXPECT_FALSE(loaded.world.shape(loaded.world.models[0].shape).empty());
}

TEST_F(SharedCases, AnOldNameGetsAHint) {
  EXPECT_THAT(Messages(Load("range_max_hint.world")),
              ElementsAre("property 'range_max' has no effect: it is 'range [min max]' today"));
}

TEST_F(SharedCases, ABlankMarginIsNamedWithBothSizes) {
  EXPECT_THAT(
      Messages(Load("bitmap_margin.world")),
      testing::Contains("bitmap 'margin.png' has a blank margin: it is 20 x 20 pixels, but 10 x 10 pixels without its "
                        "margin, and those are stretched to the model's size, as in Stage"));
}

}  // namespace
}  // namespace troupe
