#include <gtest/gtest.h>

#include <limits>

#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"

namespace troupe::test {
namespace {

constexpr Color kRed{1.0, 0.0, 0.0, 1.0};
constexpr Color kBlue{0.0, 0.0, 1.0, 1.0};

// A robot at the origin, looking along x, with a finder 0.2 m above the ground.
class BlobfinderTest : public testing::Test {
 protected:
  BlobfinderTest() : robot_(world_.AddRobot("r", {})) {}

  void AddBox(const std::string& name, double x, double y, double size_y, const Color& color, ZRange z = {0.0, 1.0}) {
    world_.AddBox(name, x, y, 0.2, size_y, z).color = color;
  }
  SensedScene Sense(const BlobfinderParameters& parameters, Tick tick = 0) {
    WorldDescription world = world_.world();
    AddSensor(world, robot_, {0.0, 0.0, 0.2, 0.0}, parameters);
    WorldState state = PlacedState(world);
    state.tick = tick;
    return {world, state};
  }
  std::vector<Blob> Find(const BlobfinderParameters& parameters = {}, Tick tick = 0) {
    return Sense(parameters, tick).MeasureAs<BlobfinderReading>(robot_, 0).blobs;
  }

  SmallWorld world_;
  RobotId robot_;
};

TEST_F(BlobfinderTest, NeighboursOfOneColorAreOneBlob) {
  AddBox("a", 2.1, 0.5, 1.0, kRed);
  AddBox("b", 2.1, -0.5, 1.0, kRed);
  AddBox("c", 2.1, -1.5, 1.0, kBlue);
  const std::vector<Blob> blobs = Find({.fov = 1.0});
  ASSERT_EQ(blobs.size(), 2u);
  EXPECT_EQ(blobs[0].color, kRed);
  EXPECT_EQ(blobs[1].color, kBlue);
  EXPECT_EQ(blobs[0].right, blobs[1].left);
  EXPECT_NEAR(blobs[0].range, 2.0, 1e-3);
}

TEST_F(BlobfinderTest, EdgesAreThoseOfTheBlockAtItsHeight) {
  // Ahead, from -0.1 to 0.3 m, seen from 0.2 m: rows are as high as columns are wide.
  AddBox("a", 2.1, 0.0, 0.2, kRed, {0.0, 0.3});
  AddBox("above", 2.1, 0.0, 0.2, kBlue, {0.3, 3.0});
  const std::vector<Blob> blobs = Find({.width = 100, .height = 80, .range = 5.0, .fov = 1.0});
  ASSERT_EQ(blobs.size(), 1u);
  EXPECT_EQ(blobs[0].color, kRed);
  EXPECT_EQ(blobs[0].left, 45u);
  EXPECT_EQ(blobs[0].right, 55u);
  EXPECT_EQ(blobs[0].top, 35u);     // 40 - 100 atan(0.1 / 2) = 35.004
  EXPECT_EQ(blobs[0].bottom, 50u);  // 40 + 100 atan(0.2 / 2) = 49.97
}

TEST_F(BlobfinderTest, OnlyTheGivenColorsAreFound) {
  AddBox("a", 2.1, 0.5, 1.0, kRed);
  AddBox("b", 2.1, -0.5, 1.0, kBlue);
  const std::vector<Blob> blobs = Find({.fov = 0.5, .colors = {kBlue}});
  ASSERT_EQ(blobs.size(), 1u);
  EXPECT_EQ(blobs[0].color, kBlue);
  EXPECT_EQ(blobs[0].left, 40u);
  EXPECT_EQ(blobs[0].right, 80u);
}

TEST_F(BlobfinderTest, ABodyOfAnotherColorHidesAndOneAtAnotherHeightDoesNot) {
  AddBox("far", 3.0, 0.0, 1.0, kRed);
  AddBox("near", 2.0, 0.0, 1.0, kBlue, {0.5, 1.0});
  ASSERT_EQ(Find({.fov = 0.1}).size(), 1u);
  EXPECT_EQ(Find({.fov = 0.1})[0].color, kRed);
  AddBox("nearer", 1.0, 0.0, 1.0, kBlue);
  EXPECT_EQ(Find({.fov = 0.1})[0].color, kBlue);
}

TEST_F(BlobfinderTest, NothingIsFoundBeyondItsRange) {
  AddBox("a", 2.1, 0.0, 4.0, kRed);
  EXPECT_TRUE(Find({.range = 1.9}).empty());
}

TEST_F(BlobfinderTest, ALightThatIsOffIsDark) {
  AddBox("lamp", 2.1, 0.0, 0.2, kRed);
  world_.world().models.back().blinking = {200'000'000, 100'000'000};  // a tick on, a tick off
  EXPECT_EQ(Find({.colors = {kRed}}, 4).size(), 1u);
  EXPECT_EQ(Find({.colors = {kRed}}, 5).size(), 0u);
  EXPECT_EQ(Find({}, 5).size(), 1u);
}

TEST_F(BlobfinderTest, ALineOfAScanLogHasAllOfIt) {
  AddBox("a", 1.1, 0.0, 8.0, kRed, {0.0, 9.0});
  EXPECT_EQ(
      Sense({.width = 2, .height = 2, .fov = 0.0001}).JsonLines(robot_, 0),
      "{\"tick\":0,\"robot\":\"r\",\"sensor\":\"blobfinder:0\",\"blobs\":[{\"color\":[1,0,0],\"left\":0,\"top\":0,"
      "\"right\":2,\"bottom\":2,\"range\":1.0000000003125}]}\n");
}

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

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A robot at the origin, looking along x, with a camera 0.5 m above the ground of 90 by 90 degrees: at a depth of d m
// a picture of n pixels is 2 d m wide and high.
class CameraTest : public testing::Test {
 protected:
  CameraTest() : robot_(world_.AddRobot("r", {})) {}

  static CameraParameters Square(std::uint32_t pixels) {
    CameraParameters camera;
    camera.width = camera.height = pixels;
    camera.fov = 0.5 * kPi;
    camera.elevation = {-0.25 * kPi, 0.25 * kPi};
    camera.range = {0.2, 8.0};
    return camera;
  }
  SensedScene Sense(const CameraParameters& parameters) {
    WorldDescription world = world_.world();
    AddSensor(world, robot_, {0.0, 0.0, 0.5, 0.0}, parameters);
    return SensedScene(world);
  }
  CameraReading Look(const CameraParameters& parameters) {
    return Sense(parameters).MeasureAs<CameraReading>(robot_, 0);
  }
  std::int32_t IdOf(const std::string& name) {
    const std::vector<ModelDescription>& models = world_.world().models;
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (models[i].name == name) return static_cast<std::int32_t>(i);
    }
    return -99;
  }

  SmallWorld world_;
  RobotId robot_;
};

TEST_F(CameraTest, AnEmptyWorldIsGroundAndSky) {
  const CameraReading reading = Look(Square(4));
  const std::vector<std::int32_t> models(reading.models.begin(), reading.models.end());
  constexpr std::int32_t kSky = CameraReading::kNothing;
  constexpr std::int32_t kGround = CameraReading::kGround;
  EXPECT_EQ(models, (std::vector<std::int32_t>{kSky, kSky, kSky, kSky, kSky, kSky, kSky, kSky, kGround, kGround,
                                               kGround, kGround, kGround, kGround, kGround, kGround}));
  EXPECT_EQ(reading.depths[0], kInfinity);
  EXPECT_FLOAT_EQ(reading.depths[8], 2.0f);  // 0.25 m down for each m ahead
  EXPECT_FLOAT_EQ(reading.depths[12], 2.0f / 3.0f);
  EXPECT_NEAR(reading.focal_length_x, 2.0, 1e-12);
  EXPECT_NEAR(reading.focal_length_y, 2.0, 1e-12);
  EXPECT_NEAR(reading.center_x, 2.0, 1e-12);
  EXPECT_NEAR(reading.center_y, 2.0, 1e-12);
}

TEST_F(CameraTest, ATableIsSeenFromAboveAndFromBelow) {
  world_.AddBox("table", 2.0, 0.0, 2.0, 2.0, {0.7, 0.75});
  CameraParameters camera = Square(40);
  const CameraReading below = Look(camera);
  // Its underside, 0.2 m up, from 1 m to 3 m: 0.2 to 0.067 m up for each m.
  const auto at = [](std::uint32_t row) { return std::size_t{row} * 40 + 20; };
  EXPECT_EQ(below.models[at(17)], IdOf("table"));  // 0.125 up
  EXPECT_FLOAT_EQ(below.depths[at(17)], 1.6f);
  EXPECT_EQ(below.models[at(15)], IdOf("table"));  // 0.225: its edge
  EXPECT_FLOAT_EQ(below.depths[at(15)], 1.0f);
  EXPECT_EQ(below.models[at(14)], CameraReading::kNothing);       // 0.275
  EXPECT_LT(below.colors[3 * at(17)], below.colors[3 * at(15)]);  // darker

  WorldDescription world = world_.world();
  AddSensor(world, robot_, {0.0, 0.0, 1.0, 0.0}, camera);
  const CameraReading above = SensedScene(world).MeasureAs<CameraReading>(robot_, 0);
  EXPECT_EQ(above.models[at(22)], IdOf("table"));  // 0.125 down: its top, 0.25 m below
  EXPECT_FLOAT_EQ(above.depths[at(22)], 2.0f);
  EXPECT_EQ(above.models[at(25)], IdOf("table"));  // 0.275: its edge
  EXPECT_FLOAT_EQ(above.depths[at(25)], 1.0f);
  EXPECT_EQ(above.models[at(26)], CameraReading::kGround);  // 0.325: under it
}

TEST_F(CameraTest, DepthsOutOfTheLimitsAreInfinite) {
  world_.AddBox("near", 0.2, 0.0, 0.2, 4.0, {0.0, 4.0});
  EXPECT_EQ(Look(Square(2)).depths[0], -kInfinity);
  EXPECT_EQ(Look(Square(2)).models[0], IdOf("near"));
  CameraParameters short_sighted = Square(2);
  short_sighted.range = {0.0, 0.05};
  EXPECT_EQ(Look(short_sighted).depths[0], kInfinity);
}

TEST_F(CameraTest, ALensThatLooksDownIsShifted) {
  CameraParameters camera = Square(10);
  camera.elevation = {-0.25 * kPi, -0.1};
  const CameraReading reading = Look(camera);
  EXPECT_LT(reading.center_y, 0.0);
  for (const std::int32_t model : reading.models) EXPECT_EQ(model, CameraReading::kGround);
}

TEST_F(CameraTest, ItDoesNotSeeItsOwnRobot) {
  world_.AddPart(robot_, "mast", {0.5, 0.0, 0.0, 0.0}, 0.1, 4.0, {0.0, 4.0});
  EXPECT_EQ(Look(Square(4)).models[0], CameraReading::kNothing);
}

TEST_F(CameraTest, ALineOfAScanLogHasDepthsAndColors) {
  world_.AddBox("wall", 1.1, 0.0, 0.2, 8.0, {0.4, 0.9});
  world_.world().models.back().color = {1.0, 0.0, 0.0, 1.0};
  CameraParameters camera = Square(1);
  camera.height = 2;
  EXPECT_EQ(Sense(camera).JsonLines(robot_, 0),
            "{\"tick\":0,\"robot\":\"r\",\"sensor\":\"camera:0\",\"width\":1,\"height\":2,\"depths\":[null,1],"
            "\"colors\":\"d6e1ecc4c2bc\"}\n");
}

}  // namespace
}  // namespace troupe::test
