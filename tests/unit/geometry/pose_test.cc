#include "troupe/pose.h"

#include <gtest/gtest.h>

#include "troupe/random.h"

namespace troupe {
namespace {

Pose RandomPose(std::uint64_t seed) {
  const auto draw = [&](std::uint64_t i) { return 2.0 * RandomUniform({seed, i}) - 1.0; };
  return {10.0 * draw(0), 10.0 * draw(1), draw(2), kPi * draw(3)};
}

void ExpectNear(const Pose& a, const Pose& b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
  EXPECT_NEAR(WrapAngle(a.heading - b.heading), 0.0, 1e-12);
}

TEST(Pose, ComposesAsGroup) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Pose a = RandomPose(3 * seed);
    const Pose b = RandomPose(3 * seed + 1);
    const Pose c = RandomPose(3 * seed + 2);
    ExpectNear((a * b) * c, a * (b * c));
    ExpectNear(a * Inverse(a), Pose{});
    ExpectNear(Inverse(a) * a, Pose{});
    const Vec2 p(0.3, -0.7);
    EXPECT_LT((Transform2(a * b) * p - Transform2(a) * (Transform2(b) * p)).norm(), 1e-12);
    EXPECT_LT((Transform2(a).InverseTransform(Transform2(a) * p) - p).norm(), 1e-12);
  }
}

TEST(Pose, IdentityChangesNoBit) {
  const Pose pose{0.1, -7.3, 0.5, 3.0};
  EXPECT_EQ(pose * Pose{}, pose);
  EXPECT_EQ(Pose{} * pose, pose);
}

TEST(Integrate, FollowsALineWithoutTurning) {
  const Pose moved = Integrate({.vx = 2.0, .vy = -1.0, .wz = 0.0}, 0.5);
  EXPECT_EQ(moved, (Pose{1.0, -0.5, 0.0, 0.0}));
}

TEST(Integrate, FollowsACircle) {
  // Radius 2 m, a quarter of a turn to the left.
  const Pose moved = Integrate({.vx = kPi, .vy = 0.0, .wz = 0.5 * kPi}, 1.0);
  ExpectNear(moved, {2.0, 2.0, 0.0, 0.5 * kPi});
}

TEST(Integrate, IsContinuousAtTheSwitchToTheSeries) {
  for (double wz : {1e-12, 1e-6, 0.99e-4, 1.01e-4, 1e-3}) {
    const Pose whole = Integrate({.vx = 1.0, .vy = 0.5, .wz = wz}, 1.0);
    const Pose half = Integrate({.vx = 1.0, .vy = 0.5, .wz = wz}, 0.5);
    ExpectNear(whole, half * half);
  }
}

}  // namespace
}  // namespace troupe
