#include <gtest/gtest.h>

#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"

namespace troupe::test {
namespace {

// A robot at the origin, looking along x, with a finder in its middle, 0.2 m above the ground.
class FiducialTest : public testing::Test {
 protected:
  FiducialTest() : robot_(world_.AddRobot("r", {})) {}

  void AddTarget(const std::string& name, double x, double y, ZRange z, std::int32_t id = 5) {
    world_.AddBox(name, x, y, 0.2, 0.2, z).fiducial_return = id;
  }
  std::vector<Fiducial> Find(const FiducialParameters& parameters = {}) {
    WorldDescription world = world_.world();
    const std::size_t sensor = AddSensor(world, robot_, {0.0, 0.0, 0.2, 0.0}, parameters);
    return SensedScene(world).MeasureAs<FiducialReading>(robot_, sensor).fiducials;
  }

  SmallWorld world_;
  RobotId robot_;
};

TEST_F(FiducialTest, ReadsRangeBearingAndPose) {
  AddTarget("t", 3.0, 4.0, {0.0, 1.0});
  const std::vector<Fiducial> found = Find();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].id, 5);
  EXPECT_DOUBLE_EQ(found[0].range, 5.0);
  EXPECT_DOUBLE_EQ(found[0].bearing, Atan2(4.0, 3.0));
  EXPECT_EQ(found[0].X_WF, (Pose{3.0, 4.0, 0.0, 0.0}));
  EXPECT_NEAR(found[0].X_SF.z, -0.2, 1e-15);
  EXPECT_EQ(found[0].size_x, 0.2);
}

TEST_F(FiducialTest, ADistantModelHasNoId) {
  AddTarget("t", 6.0, 0.0, {0.0, 1.0});
  ASSERT_EQ(Find().size(), 1u);
  EXPECT_EQ(Find()[0].id, 0);
  EXPECT_EQ(Find({.id_range = 6.0})[0].id, 5);
}

TEST_F(FiducialTest, RangeKeyAndFieldOfViewBoundIt) {
  AddTarget("ahead", 3.0, 0.0, {0.0, 1.0});
  AddTarget("behind", -3.0, 0.0, {0.0, 1.0});
  EXPECT_EQ(Find().size(), 1u);
  EXPECT_EQ(Find({.fov = 2.0 * kPi}).size(), 2u);
  EXPECT_EQ(Find({.range = {3.5, 8.0}}).size(), 0u);
  EXPECT_EQ(Find({.range = {0.0, 2.5}}).size(), 0u);
  EXPECT_EQ(Find({.key = 1}).size(), 0u);
  world_.world().models.back().fiducial_key = 1;
  EXPECT_EQ(Find({.fov = 2.0 * kPi, .key = 1}).size(), 1u);
}

TEST_F(FiducialTest, OnlyBodiesAtItsHeightHideAModel) {
  AddTarget("t", 3.0, 0.0, {0.0, 1.0});
  world_.AddBox("bar above", 1.5, 0.0, 0.2, 2.0, {0.3, 1.0}).ranger_return = -1.0;
  EXPECT_EQ(Find().size(), 1u);
  // Rangers look through it, and nothing collides with it, but it is there.
  ModelDescription& wall = world_.AddBox("wall", 1.5, 0.0, 0.2, 2.0, {0.1, 0.3});
  wall.ranger_return = -1.0;
  wall.obstacle_return = false;
  EXPECT_EQ(Find().size(), 0u);
}

TEST_F(FiducialTest, AModelMustBeAtItsHeightUnlessHeightsAreIgnored) {
  AddTarget("high", 3.0, 0.0, {0.5, 1.0});
  EXPECT_EQ(Find().size(), 0u);
  EXPECT_EQ(Find({.ignores_height = true}).size(), 1u);
  world_.AddBox("wall behind", 4.0, 0.0, 0.2, 2.0, {0.0, 1.0});
  EXPECT_EQ(Find({.ignores_height = true}).size(), 1u);
  world_.AddBox("wall", 2.0, 0.0, 0.2, 2.0, {0.0, 1.0});
  EXPECT_EQ(Find({.ignores_height = true}).size(), 0u);
}

TEST_F(FiducialTest, APartOfAModelShowsTheModel) {
  const RobotId other = world_.AddRobot("other", {3.0, 0.0, 0.0, 0.0});
  world_.world().models[world_.robot(other).root.index()].fiducial_return = 9;
  world_.AddPart(other, "shield", {-0.4, 0.0, 0.0, 0.0}, 0.1, 1.0, {0.0, 0.5});
  ASSERT_EQ(Find().size(), 1u);
  EXPECT_EQ(Find()[0].model, world_.robot(other).root);
}

TEST_F(FiducialTest, ItDoesNotFindItsOwnRobot) {
  world_.world().models[world_.robot(robot_).root.index()].fiducial_return = 9;
  world_.AddPart(robot_, "flag", {0.5, 0.0, 0.0, 0.0}, 0.1, 0.1, {0.0, 0.5}).fiducial_return = 9;
  EXPECT_EQ(Find({.ignores_height = true}).size(), 0u);
}

TEST_F(FiducialTest, ALineOfAScanLogHasAllOfIt) {
  AddTarget("t", 2.0, 0.0, {0.0, 1.0});
  WorldDescription world = world_.world();
  const std::size_t sensor = AddSensor(world, robot_, {0.0, 0.0, 0.25, 0.0}, FiducialParameters{});
  EXPECT_EQ(
      SensedScene(world).JsonLines(robot_, sensor),
      "{\"tick\":0,\"robot\":\"r\",\"sensor\":\"fiducial:0\",\"fiducials\":[{\"id\":5,\"model\":\"t\",\"range\":2,"
      "\"bearing\":0,\"pose\":[2,0,-0.25,0],\"size\":[0.2,0.2,1]}]}\n");
}

}  // namespace
}  // namespace troupe::test
