#include <gtest/gtest.h>

#include "troupe/sensor.h"

namespace troupe {
namespace {

constexpr double kAngles[] = {0.0, 0.1, 1.0, 1.0 / 3.0, 3.14159265358979323846, 4.7, 6.283185307179586};
constexpr std::size_t kCounts[] = {1, 2, 3, 5, 16, 91, 180, 181, 361, 1080, 4096};

template <typename Check>
void ForAllFans(Check check) {
  for (const double fov : kAngles) {
    for (const std::size_t count : kCounts) {
      SCOPED_TRACE(std::to_string(fov) + " rad, " + std::to_string(count) + " rays");
      check(RayFan{fov, count});
    }
  }
}

TEST(RayFanTest, SpansTheFieldOfViewWithBothEnds) {
  const RayFan fan{2.0, 5};
  const double bearings[] = {-1.0, -0.5, 0.0, 0.5, 1.0};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(fan.Bearing(i), bearings[i]);
}

TEST(RayFanTest, TheEndsAreExact) {
  ForAllFans([](const RayFan& fan) {
    const double half = fan.count > 1 ? 0.5 * fan.fov : 0.0;
    EXPECT_EQ(fan.angle_min(), -half);
    EXPECT_EQ(fan.angle_max(), half);
    EXPECT_EQ(fan.Bearing(0), fan.angle_min());
    EXPECT_EQ(fan.Bearing(fan.count - 1), fan.angle_max());
  });
}

TEST(RayFanTest, LeftAndRightAreMirrorImages) {
  ForAllFans([](const RayFan& fan) {
    for (std::size_t i = 0; i < fan.count; ++i) EXPECT_EQ(fan.Bearing(i), -fan.Bearing(fan.count - 1 - i));
  });
}

TEST(RayFanTest, MinimumAndIncrementReproduceEachBearing) {
  ForAllFans([](const RayFan& fan) {
    for (std::size_t i = 0; i < fan.count; ++i) {
      EXPECT_NEAR(fan.angle_min() + static_cast<double>(i) * fan.angle_increment(), fan.Bearing(i), 1e-12);
    }
  });
}

TEST(RayFanTest, ASingleRayPointsStraightAhead) {
  const RayFan fan{1.0, 1};
  EXPECT_EQ(fan.Bearing(0), 0.0);
  EXPECT_EQ(fan.angle_min(), 0.0);
  EXPECT_EQ(fan.angle_increment(), 0.0);
}

}  // namespace
}  // namespace troupe
