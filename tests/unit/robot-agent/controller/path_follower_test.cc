// The path follower of slotcar, tick by tick.
#include "robot-agent/controller/path_follower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "troupe/deterministic_math.h"

namespace troupe::path_follower_test {
namespace {

constexpr double kInterval = 0.1;

DriveDescription Drive(double most_backwards) {
  DriveDescription drive;
  drive.velocity = {{most_backwards, 0.5}, {0.0, 0.0}, {-0.6, 0.6}};
  drive.acceleration = {{-0.75, 0.75}, {0.0, 0.0}, {-2.0, 2.0}};
  return drive;
}

struct Trip {
  Pose end;
  double seconds = 0.0;
  double fastest = 0.0;        // m/s
  double least_heading = 0.0;  // rad
  double most_heading = 0.0;
};

// Until the robot stands at the end, or for 100 s.
Trip Drive(PathFollower& follower, Pose at, double until = 100.0) {
  Trip trip{.end = at};
  for (; trip.seconds < until; trip.seconds += kInterval) {
    const Twist twist = follower.Update(trip.end, trip.seconds, kInterval, false);
    if (twist == Twist() && follower.state() == PathFollower::State::kStands) break;
    trip.fastest = std::max(trip.fastest, std::fabs(twist.vx));
    trip.end = trip.end * Pose{twist.vx * kInterval, 0.0, 0.0, twist.wz * kInterval};
    trip.least_heading = std::min(trip.least_heading, trip.end.heading);
    trip.most_heading = std::max(trip.most_heading, trip.end.heading);
  }
  return trip;
}

TEST(PathFollower, TurnsAndDrivesFromPointToPoint) {
  PathFollower follower(Drive(0.0), {});
  ASSERT_TRUE(follower.Follow({{Vec2(0, 0)}, {Vec2(2, 0)}, {Vec2(2, 3), 2.0}}, Vec2(0.1, 0)));
  const Trip trip = Drive(follower, {});
  EXPECT_NEAR(trip.end.x, 2.0, 0.03);
  EXPECT_NEAR(trip.end.y, 3.0, 0.03);
  EXPECT_NEAR(trip.end.heading, 2.0, 0.011);
  EXPECT_LE(trip.fastest, 0.5);
  EXPECT_EQ(follower.next(), 3u);
}

TEST(PathFollower, DrivesBackwardsIfTheDriveCan) {
  for (const double backwards : {0.0, -0.5}) {
    PathFollower follower(Drive(backwards), {});
    ASSERT_TRUE(follower.Follow({{Vec2(0, 0)}, {Vec2(-2, 0)}}, Vec2(0, 0)));
    const Trip trip = Drive(follower, {});
    EXPECT_NEAR(trip.end.x, -2.0, 0.03);
    EXPECT_EQ(trip.most_heading - trip.least_heading > 3.0, backwards == 0.0) << "it has turned round";
  }
}

TEST(PathFollower, ObeysTheLimitsOfItsPath) {
  PathFollower follower(Drive(0.0), {});
  ASSERT_TRUE(follower.Follow({{Vec2(0, 0)}, {Vec2(2, 0), 0.0, 0.2}}, Vec2(0, 0)));
  EXPECT_NEAR(Drive(follower, {}).fastest, 0.2, 1e-12);
}

TEST(PathFollower, LeavesAPointAtItsTime) {
  PathFollower follower(Drive(0.0), {});
  ASSERT_TRUE(follower.Follow({{Vec2(0, 0)}, {Vec2(1, 0), 0.0, 0.0, 20.0}, {Vec2(2, 0)}}, Vec2(0, 0)));
  const Trip waits = Drive(follower, {}, 19.0);
  EXPECT_NEAR(waits.end.x, 1.0, 0.03);
  EXPECT_EQ(follower.state(), PathFollower::State::kHolds);
  ASSERT_TRUE(follower.Follow({{Vec2(0, 0)}, {Vec2(1, 0), 0.0, 0.0, 20.0}, {Vec2(2, 0)}}, Vec2(0, 0)));
  const Trip trip = Drive(follower, {});
  EXPECT_NEAR(trip.end.x, 2.0, 0.03);
  EXPECT_GT(trip.seconds, 21.9);
}

TEST(PathFollower, PausesAtOnceAndAtACheckpoint) {
  PathFollower follower(Drive(0.0), {});
  ASSERT_TRUE(
      follower.Follow({{Vec2(0, 0), 0, 0, 0, 0}, {Vec2(1, 0), 0, 0, 0, 1}, {Vec2(2, 0), 0, 0, 0, 2}}, Vec2(0, 0)));
  follower.SetPause(PathFollower::Pause::kNow);
  EXPECT_EQ(Drive(follower, {}, 5.0).end.x, 0.0);
  EXPECT_EQ(follower.state(), PathFollower::State::kHolds);
  follower.SetPause(PathFollower::Pause::kAtCheckpoint, 1);
  const Trip trip = Drive(follower, {}, 30.0);
  EXPECT_NEAR(trip.end.x, 1.0, 0.03);
  follower.SetPause(PathFollower::Pause::kNone);
  EXPECT_NEAR(Drive(follower, trip.end).end.x, 2.0, 0.03);
}

TEST(PathFollower, StandsForAPathThatBeginsElsewhere) {
  PathFollower follower(Drive(0.0), {});
  ASSERT_TRUE(follower.Follow({{Vec2(0, 0)}, {Vec2(5, 0)}}, Vec2(0, 0)));
  EXPECT_FALSE(follower.Follow({{Vec2(9, 0)}, {Vec2(5, 0)}}, Vec2(0, 0)));
  EXPECT_EQ(Drive(follower, {}).end, Pose());
}

TEST(PathFollower, WaitsForWhatIsInItsWay) {
  PathFollower follower(Drive(0.0), {});
  ASSERT_TRUE(follower.Follow({{Vec2(0, 0)}, {Vec2(5, 0)}}, Vec2(0, 0)));
  EXPECT_EQ(follower.Update({}, 0.0, kInterval, true).vx, 0.0);
  EXPECT_EQ(follower.state(), PathFollower::State::kWaits);
  EXPECT_GT(follower.Update({}, 0.1, kInterval, false).vx, 0.0);
}

}  // namespace
}  // namespace troupe::path_follower_test
