#include "ros/messages/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/small_world.h"

namespace troupe::ros {
namespace {

using testing::Each;
using testing::ElementsAre;

TEST(ToTime, IsExactAfterAnyNumberOfTicks) {
  EXPECT_EQ(ToTime(0, 100'000'000).sec, 0);
  const Time time = ToTime(1'000'003, 100'000'000);
  EXPECT_EQ(time.sec, 100'000);
  EXPECT_EQ(time.nanosec, 300'000'000u);
  EXPECT_EQ(ToTime(3, 999'999'999).sec, 2);
  EXPECT_EQ(ToTime(3, 999'999'999).nanosec, 999'999'997u);
}

TEST(ToMessage, ConvertsAHeadingToARotationAboutZ) {
  const PoseMessage pose = ToMessage(Pose{1.0, 2.0, 3.0, kPi / 2});
  EXPECT_EQ(pose.position.x, 1.0);
  EXPECT_EQ(pose.position.y, 2.0);
  EXPECT_EQ(pose.position.z, 3.0);
  EXPECT_EQ(pose.orientation.x, 0.0);
  EXPECT_EQ(pose.orientation.y, 0.0);
  EXPECT_NEAR(pose.orientation.z, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(pose.orientation.w, std::sqrt(0.5), 1e-15);
}

TEST(MakeOdometry, ContainsPoseTwistAndCovariances) {
  dds::WireArena arena;
  const Covariance error{.x = 0.1, .y = 0.2, .heading = 0.3, .vx = 0.4, .vy = 0.5, .wz = 0.6};
  const OdometryMessage odometry =
      MakeOdometry({7, 5}, "r/odom", "r/base_link", {1, 2, 0, 0}, {0.5, 0.25, -1.0}, error, arena);
  EXPECT_EQ(odometry.header.stamp.sec, 7);
  EXPECT_EQ(odometry.header.stamp.nanosec, 5u);
  EXPECT_STREQ(odometry.header.frame_id, "r/odom");
  EXPECT_STREQ(odometry.child_frame_id, "r/base_link");
  EXPECT_EQ(odometry.pose.pose.position.y, 2.0);
  EXPECT_EQ(odometry.twist.twist.linear.x, 0.5);
  EXPECT_EQ(odometry.twist.twist.linear.y, 0.25);
  EXPECT_EQ(odometry.twist.twist.angular.z, -1.0);
  EXPECT_EQ(odometry.pose.covariance[0], 0.1);
  EXPECT_EQ(odometry.pose.covariance[7], 0.2);
  EXPECT_EQ(odometry.pose.covariance[35], 0.3);
  EXPECT_EQ(odometry.twist.covariance[0], 0.4);
  EXPECT_EQ(odometry.twist.covariance[7], 0.5);
  EXPECT_EQ(odometry.twist.covariance[35], 0.6);
  for (const std::size_t z_roll_pitch : {14, 21, 28}) EXPECT_EQ(odometry.pose.covariance[z_roll_pitch], kLeastVariance);
  EXPECT_EQ(odometry.pose.covariance[1], 0.0);
}

TEST(MakeLaserScan, HasTheAnglesOfTheFan) {
  const RangeScan measured{
      .ranges = {1, 2, 3, 8}, .intensities = {1, 1, 0.5, 0}, .fan = {3.0, 4}, .limits = {0.25, 8.0}};
  dds::WireArena arena;
  const LaserScan scan = MakeLaserScan({}, "r/scan", measured, 3 * 0.1, false, arena);
  EXPECT_EQ(scan.angle_min, -1.5F);
  EXPECT_EQ(scan.angle_max, 1.5F);
  EXPECT_EQ(scan.angle_increment, 1.0F);
  EXPECT_FLOAT_EQ(scan.scan_time, 0.3F);
  EXPECT_EQ(scan.range_min, 0.25F);
  EXPECT_EQ(scan.range_max, 8.0F);
  EXPECT_THAT(dds::Elements(scan.ranges), ElementsAre(1.0F, 2.0F, 3.0F, 8.0F));
  EXPECT_THAT(dds::Elements(scan.intensities), ElementsAre(1.0F, 1.0F, 0.5F, 0.0F));
  const LaserScan infinite = MakeLaserScan({}, "r/scan", measured, 3 * 0.1, true, arena);
  EXPECT_THAT(dds::Elements(infinite.ranges), ElementsAre(1.0F, 2.0F, 3.0F, std::numeric_limits<float>::infinity()));
  EXPECT_EQ(infinite.range_max, 8.0F);
}

TEST(MakeRange, HasNoVarianceInHumble) {
  const RangeScan scan{.ranges = {1.5}, .intensities = {1.0}, .fan = {0.25, 1}, .limits = {0.0, 4.0}, .variance = 0.5};
  dds::WireArena arena;
  const RangeMessage range = MakeRange({1, 2}, "r/sonar_0", scan, arena);
  EXPECT_EQ(range.range, 1.5F);
  EXPECT_EQ(range.max_range, 4.0F);
  EXPECT_EQ(range.field_of_view, 0.25F);
  EXPECT_EQ(range.variance, 0.5F);
  const HumbleRangeMessage humble = WithoutVariance(range);
  EXPECT_STREQ(humble.header.frame_id, "r/sonar_0");
  EXPECT_EQ(humble.range, 1.5F);
  EXPECT_EQ(humble.max_range, 4.0F);
}

TEST(OdomInMap, ClosesTheChainFromTheMapToTheRobot) {
  const Pose X_WR{3.0, -2.0, 0.25, 1.0};
  const Pose estimate{0.5, 0.25, 0.0, -0.5};
  LocalizationDescription odometry;
  odometry.type = LocalizationType::kOdometry;
  const Pose chain = OdomInMap(odometry, X_WR, estimate) * estimate;
  EXPECT_NEAR(chain.x, X_WR.x, 1e-12);
  EXPECT_NEAR(chain.y, X_WR.y, 1e-12);
  EXPECT_NEAR(chain.z, X_WR.z, 1e-12);
  EXPECT_NEAR(chain.heading, X_WR.heading, 1e-12);
  EXPECT_EQ(OdomInMap(LocalizationDescription{}, X_WR, X_WR), Pose{});
}

}  // namespace
}  // namespace troupe::ros
