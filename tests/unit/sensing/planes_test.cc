// Scanners with several planes.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"

namespace troupe::test {
namespace {

RangeScan Scan(SmallWorld& small, RaySensorDescription sensor) {
  WorldDescription world = small.world();
  AddSensor(world, RobotId(0), {0.0, 0.0, 0.5, 0.0}, RangerParameters{{std::move(sensor)}});
  return SensedScene(world).MeasureAs<RangerReading>(RobotId(0), 0).scans[0];
}

RaySensorDescription Planes(std::vector<double> elevations) {
  RaySensorDescription sensor = Fan(0.2, 3, 10.0);
  sensor.elevations = std::move(elevations);
  return sensor;
}

TEST(Planes, HitTopsUndersidesSidesAndTheGround) {
  SmallWorld world;
  world.AddRobot("r", {});
  world.AddBox("table", 3.0, 0.0, 4.0, 4.0, {0.3, 0.4}).ranger_return = 0.5;
  world.AddBox("lamp", 3.0, 0.0, 4.0, 4.0, {1.0, 1.1});
  const double up = std::atan(0.25);
  const double down = std::atan(0.05);
  const double steep = std::atan(0.8);
  const RangeScan scan = Scan(world, Planes({-steep, -down, 0.0, up}));
  ASSERT_EQ(scan.ranges.size(), 12u);
  ASSERT_EQ(scan.planes(), 4u);
  EXPECT_NEAR(scan.ranges[1], 0.5 / std::sin(steep), 1e-9);  // the ground
  EXPECT_EQ(scan.intensities[1], 1.0);
  EXPECT_NEAR(scan.ranges[4], 2.0 / std::cos(down), 1e-9);  // the table's top, 0.1 m lower
  EXPECT_EQ(scan.intensities[4], 0.5);
  EXPECT_EQ(scan.ranges[7], 10.0);  // between both
  EXPECT_EQ(scan.intensities[7], 0.0);
  EXPECT_NEAR(scan.ranges[10], 2.0 / std::cos(up), 1e-9);  // the lamp's underside, 0.5 m higher
  EXPECT_EQ(FlattestPlane(scan), 2u);
}

TEST(Planes, NoiseDiffersBetweenPlanesAndRepeats) {
  SmallWorld world;
  world.AddRobot("r", {});
  world.AddBox("wall", 3.0, 0.0, 2.0, 8.0, {0.0, 4.0});
  RaySensorDescription sensor = Planes({-0.001, 0.001});
  const RangeScan exact = Scan(world, sensor);
  sensor.noise_variance = 0.01;
  const RangeScan noisy = Scan(world, sensor);
  EXPECT_EQ(noisy, Scan(world, sensor));
  EXPECT_NE(noisy.ranges[0] - exact.ranges[0], noisy.ranges[3] - exact.ranges[3]);
  for (std::size_t i = 0; i < noisy.ranges.size(); ++i) EXPECT_NE(noisy.ranges[i], exact.ranges[i]);
}

}  // namespace
}  // namespace troupe::test
