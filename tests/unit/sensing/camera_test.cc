#include <gtest/gtest.h>

#include <limits>

#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"

namespace troupe::test {
namespace {

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
