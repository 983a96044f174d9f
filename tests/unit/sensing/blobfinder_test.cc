#include <gtest/gtest.h>

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

}  // namespace
}  // namespace troupe::test
