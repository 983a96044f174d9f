#include <gtest/gtest.h>

#include "launcher/supervise/restarts.h"

namespace troupe {
namespace {

TEST(ServiceRestartsTest, TheFirstDeathAtATickIsFollowedByARestartAtOnce) {
  ServiceRestarts restarts;
  for (const StatePlace& newest : {StatePlace{0, 0}, StatePlace{0, 7}, StatePlace{0, 9}, StatePlace{1, 9}}) {
    EXPECT_EQ(restarts.OnDeath(newest, 5.0), 5.0);
    EXPECT_EQ(restarts.due(), 5.0);
    restarts.OnStart();
    EXPECT_FALSE(restarts.due());
  }
  EXPECT_EQ(restarts.count(), 4u);
}

TEST(ServiceRestartsTest, DeathsAtOneTickAreFollowedByLaterRestartsAndAnEnd) {
  ServiceRestarts restarts;
  double before = 0.0;
  std::uint32_t count = 0;
  while (const std::optional<double> due = restarts.OnDeath({0, 3}, 100.0)) {
    EXPECT_GE(*due, 100.0 + before);
    before = *due - 100.0;
    restarts.OnStart();
    ASSERT_LT(++count, 20u);
  }
  EXPECT_GT(count, 3u);
  EXPECT_TRUE(restarts.OnDeath({0, 4}, 100.0)) << "there was progress since";
}

}  // namespace
}  // namespace troupe
