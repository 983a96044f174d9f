#include <gtest/gtest.h>

#include <set>

#include "common/sensing/sensor_suite.h"
#include "tests/support/gripper_world.h"
#include "tests/support/small_world.h"

namespace troupe {
namespace {

TEST(SensorRegistryTest, FindsEachKindByItsName) {
  std::set<std::string_view> names;
  for (const SensorKind& kind : SensorKinds()) {
    EXPECT_EQ(FindSensorKind(kind.type), &kind);
    EXPECT_TRUE(names.insert(kind.type).second) << kind.type;
  }
  EXPECT_EQ(FindSensorKind("thermometer"), nullptr);
  EXPECT_EQ(FindSensorKind(""), nullptr);
}

TEST(SensorRegistryTest, HasAKindForEachAlternativeOfADescription) {
  EXPECT_EQ(SensorKinds().size(), std::variant_size_v<SensorParameters>);
  EXPECT_NE(FindSensorKind(TypeOf(RangerParameters())), nullptr);
  EXPECT_NE(FindSensorKind(TypeOf(BreakBeamParameters())), nullptr);
}

TEST(SensorRegistryTest, ARobotWithoutSensorsHasNone) {
  SmallWorld world;
  const RobotId robot = world.AddRobot("r0", {});
  EXPECT_TRUE(MakeSensors(Scene(world.world()), robot).empty());
}

TEST(SensorRegistryTest, DescribedSensorsPrecedeTheBeamsOfGrippers) {
  test::GripperWorld world;
  const test::GripperRobot first = world.AddGripperRobot({});
  const test::GripperRobot second = world.AddGripperRobot({4.0, 0.0, 0.0, 0.0});
  SensorDescription ranger{.name = "ranger:0", .model = world.world.robots[0].root};
  RaySensors(ranger) = {OneRay()};
  world.world.robots[0].sensors = {ranger, ranger};
  world.world.grippers[0].beams.resize(2);
  const Scene scene(world.world);
  const std::vector<std::unique_ptr<const Sensor>> sensors = MakeSensors(scene, first.robot);
  ASSERT_EQ(sensors.size(), 3u);
  const char* const types[] = {"ranger", "ranger", "break_beam"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sensors[i]->index(), i);
    EXPECT_EQ(sensors[i]->robot(), first.robot);
    EXPECT_EQ(TypeOf(sensors[i]->description().parameters), types[i]);
  }
  EXPECT_EQ(sensors[2]->description().name, world.world.grippers[0].name + ".beams");
  EXPECT_EQ(sensors[2]->description().model, world.world.grippers[0].model);
  EXPECT_TRUE(MakeSensors(scene, second.robot).empty());
}

}  // namespace
}  // namespace troupe
