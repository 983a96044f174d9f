// Worlds of the Stage project.
#include "tests/support/stage_worlds.h"

#include <filesystem>

#include "common/model/states.h"
#include "tests/support/ray_sensors.h"
#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

using testing::Each;
using testing::Field;

class StageWorlds : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = test::StageWorldsFolder();
    if (!std::filesystem::exists(folder_ + "/simple.world")) {
      GTEST_SKIP() << "no Stage worlds in " << folder_ << "; set TROUPE_STAGE_WORLDS";
    }
  }

  LoadedWorld Load(const std::string& name) const {
    Result<LoadedWorld> world = LoadWorld(folder_ + "/" + name);
    if (!world.ok()) {
      ADD_FAILURE() << world.error().ToString();
      return {};
    }
    const Status fault = Validate(world.value().world);
    if (!fault.ok()) ADD_FAILURE() << fault.error().ToString();
    return std::move(world).value();
  }

  // The height of a ray above the ground.
  static double RayHeight(const LoadedWorld& loaded, std::size_t robot, std::size_t ranger) {
    const SensorDescription& description = loaded.world.robots[robot].sensors[ranger];
    return ModelPoses(loaded.world, PlacedState(loaded.world))[description.model.index()].z +
           RaySensors(description)[0].X_MS.z;
  }

  std::string folder_;
};

TEST_F(StageWorlds, SimpleWorldLoads) {
  const LoadedWorld loaded = Load("simple.world");
  ASSERT_EQ(loaded.world.robots.size(), 2u);
  EXPECT_EQ(loaded.world.models.size(), 7u);
  EXPECT_EQ(loaded.world.robots[0].name, "r0");
  EXPECT_EQ(loaded.world.robots[1].name, "r1");
  EXPECT_THAT(loaded.world.robots,
              Each(Field(&RobotDescription::controller, Field(&ControllerDescription::name, "wander"))));
  EXPECT_EQ(loaded.settings.ticks, 36000u);
  EXPECT_EQ(loaded.map_width, 500);
  const Shape& cave = loaded.world.shape(loaded.world.models[0].shape);
  EXPECT_GT(cave.rectangles.size(), 100u);
  EXPECT_EQ(cave.blocks.size(), 4u);  // its boundary
  EXPECT_EQ(cave.rectangles_z, (ZRange{0.0, 0.8}));
  Rectangle bounds = Rectangle::Nothing();
  for (const Rectangle& r : cave.rectangles) bounds.Extend(r);
  EXPECT_EQ(bounds, (Rectangle{-8, -8, 8, 8}));
}

TEST_F(StageWorlds, RangersOfThePioneerHaveTheirHeights) {
  const LoadedWorld loaded = Load("simple.world");
  ASSERT_EQ(loaded.world.robots[0].sensors.size(), 2u);
  EXPECT_EQ(loaded.world.robots[0].sensors[0].name, "ranger:0");
  EXPECT_EQ(RaySensors(loaded.world.robots[0].sensors[0]).size(), 16u);
  EXPECT_EQ(RaySensors(loaded.world.robots[0].sensors[1])[0].samples, 180u);
  // On top of the robot (0.22) and 0.03 lower, plus half of the 0.01 high sonar.
  EXPECT_NEAR(RayHeight(loaded, 0, 0), 0.195, 1e-12);
  // On top of the robot, the sensor 0.1 higher, plus half of its default height.
  EXPECT_NEAR(RayHeight(loaded, 0, 1), 0.33, 1e-12);
}

TEST_F(StageWorlds, NoModelIsWithoutEffectAndNoControllerUnknown) {
  int worlds = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
    if (entry.path().extension() != ".world") continue;
    ++worlds;
    for (const Warning& warning : Load(std::filesystem::relative(entry.path(), folder_).string()).warnings) {
      EXPECT_THAT(warning.ToString(), testing::Not(testing::HasSubstr("not simulated yet")));
      EXPECT_THAT(warning.ToString(), testing::Not(testing::HasSubstr("is not known")));
    }
  }
  EXPECT_GE(worlds, 3);
}

TEST_F(StageWorlds, LaboratoryLoads) {
  const LoadedWorld loaded = Load("uoa_robotics_lab.world");
  ASSERT_EQ(loaded.world.robots.size(), 1u);
  EXPECT_EQ(loaded.world.models.size(), 29u);
  EXPECT_EQ(loaded.world.models[1].name, "r0");
  EXPECT_EQ(loaded.world.models[7].name, "model:1");  // the first table; the map was model 0
  const Shape& table = loaded.world.shape(loaded.world.models[7].shape);
  EXPECT_EQ(table.blocks.size(), 13u);
  EXPECT_NEAR(table.blocks[0].z.max, 0.725, 1e-12);
  EXPECT_NEAR(table.blocks[1].z.min, 0.959 * 0.725, 1e-12);
  EXPECT_EQ(loaded.world.models[7].shape, loaded.world.models[8].shape);
}

TEST_F(StageWorlds, CaveBenchmarkLoads) {
  const LoadedWorld loaded = Load("benchmark/cave.world");
  ASSERT_EQ(loaded.world.robots.size(), 100u);
  EXPECT_EQ(loaded.world.models.size(), 301u);
  EXPECT_EQ(loaded.world.shapes.size(), 4u);
  EXPECT_THAT(loaded.world.robots,
              Each(Field(&RobotDescription::controller, Field(&ControllerDescription::name, "expand"))));
  EXPECT_EQ(loaded.world.robots[99].name, "position:99");
  EXPECT_FALSE(loaded.world.models[0].obstacle_return);
  EXPECT_EQ(loaded.world.models[0].ranger_return, 0.5);
  EXPECT_LE(loaded.warnings.size(), 20u);
}

}  // namespace
}  // namespace troupe
