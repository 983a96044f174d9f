#include <gtest/gtest.h>

#include "ros/messages/convert.h"

namespace troupe::ros {
namespace {

LocalizationDescription Odometry() {
  LocalizationDescription localization{
      .type = LocalizationType::kOdometry, .error_x = 0.1, .error_y = 0.2, .error_heading = 0.05};
  return localization;
}

TEST(OdometryError, IsZeroForGps) {
  LocalizationDescription gps = Odometry();
  gps.type = LocalizationType::kGps;
  OdometryError error(gps);
  error.AddMotion({1.0, 1.0, 1.0}, 10.0);
  EXPECT_EQ(error.covariance().x, 0.0);
  EXPECT_EQ(error.covariance().wz, 0.0);
}

TEST(OdometryError, GrowsWithThePathInBothDirections) {
  OdometryError error(Odometry());
  error.AddMotion({2.0, 0.0, 0.0}, 1.0);
  EXPECT_NEAR(error.covariance().x, 0.04, 1e-12);
  EXPECT_EQ(error.covariance().y, 0.0);
  EXPECT_NEAR(error.covariance().vx, 0.04, 1e-12);
  error.AddMotion({-2.0, 0.0, 0.0}, 1.0);
  EXPECT_NEAR(error.covariance().x, 0.16, 1e-12);
  error.AddMotion({0.0, 0.0, 2.0}, 1.0);
  EXPECT_NEAR(error.covariance().heading, 0.01, 1e-12);
  EXPECT_EQ(error.covariance().vx, 0.0);
}

TEST(OdometryError, OfTheHeadingDisplacesThePosition) {
  OdometryError error(Odometry());
  error.AddMotion({1.0, 0.0, 1.0}, 2.0);
  EXPECT_NEAR(error.covariance().y, 0.04, 1e-12);
}

}  // namespace
}  // namespace troupe::ros
