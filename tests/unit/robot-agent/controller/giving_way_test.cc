// What a robot on lanes does for another one, without either.
#include "robot-agent/controller/giving_way.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <span>

namespace troupe {
namespace {

using ::testing::ElementsAre;

LaneVertex VertexAt(double x, double y) {
  LaneVertex vertex;
  vertex.position = {x, y};
  return vertex;
}

Lane BothWays(std::uint32_t start, std::uint32_t end) {
  Lane lane;
  lane.start = start;
  lane.end = end;
  lane.is_bidirectional = true;
  return lane;
}

// 0 - 1 - 2 in a line, and a way round it over 3; 4 is a siding of 1.
LaneGraph Street() {
  return {0,
          {VertexAt(0, 0), VertexAt(5, 0), VertexAt(10, 0), VertexAt(5, 8), VertexAt(5, -3)},
          {BothWays(0, 1), BothWays(1, 2), BothWays(0, 3), BothWays(3, 2), BothWays(1, 4)}};
}

constexpr RobotId kOwn(5);

class GivingWayTest : public ::testing::Test {
 protected:
  // Blocked on `leg` from 0 s on, each second; the time (s) of the way, and the way.
  std::optional<std::pair<double, WayAround>> WaitForWay(RobotId other, const Leg& leg, bool is_away = false) {
    for (double time = 0.0; time < 30.0; time += 1.0) {
      now_.time = time;
      const std::optional<BlockEnd> end = giving_.OnBlocked(place_, other, leg, is_away);
      if (end && end->way) return std::pair(time, *end->way);
    }
    return std::nullopt;
  }

  LaneGraph graph_ = Street();
  GivingWay giving_{kOwn, graph_, std::span(&graph_, 1), 1.0};
  Observation now_;
  std::vector<SeenRobot> others_;
  LanePlace place_{.now = now_, .others = others_, .radius = 0.3, .half_width = 0.2};
};

TEST_F(GivingWayTest, TakesAnotherRouteAfterAWhileAndTheLargerIdSooner) {
  place_.vertex = 0;
  place_.target = 2;
  const auto sooner = WaitForWay(RobotId(1), {0, 1, 0});
  ASSERT_TRUE(sooner);
  EXPECT_GE(sooner->first, 6.0);
  EXPECT_LE(sooner->first, 9.0);
  EXPECT_THAT(sooner->second.legs, ElementsAre(Leg{0, 3, 2}, Leg{3, 2, 3}));
  EXPECT_FALSE(sooner->second.is_on_first);
  EXPECT_FALSE(sooner->second.seconds_aside);
  const auto later = WaitForWay(RobotId(9), {0, 1, 0});
  ASSERT_TRUE(later);
  EXPECT_GE(later->first, 12.0);
}

TEST_F(GivingWayTest, GoesBackFirstFromTheMiddleOfALane) {
  place_.vertex = 0;
  place_.target = 2;
  const auto way = WaitForWay(RobotId(1), {0, 1, 0}, true);
  ASSERT_TRUE(way);
  EXPECT_TRUE(way->second.is_on_first);
  EXPECT_THAT(way->second.legs, ElementsAre(Leg{1, 0, 0}, Leg{0, 3, 2}, Leg{3, 2, 3}));
  graph_.lanes[0].is_bidirectional = false;
  EXPECT_FALSE(WaitForWay(RobotId(1), {0, 1, 0}, true)) << "it cannot go back";
}

TEST_F(GivingWayTest, DrivesOnAgainWhereItIsBlockedOnItsWayBack) {
  place_.vertex = 0;
  place_.target = 2;
  const auto way = WaitForWay(RobotId(1), {1, 0, 0}, true);
  ASSERT_TRUE(way);
  EXPECT_THAT(way->second.legs, ElementsAre(Leg{0, 1, 0}, Leg{1, 2, 1}));
}

TEST_F(GivingWayTest, GoesAsideWhereNoOtherRouteIsWorthIt) {
  place_.vertex = 1;
  place_.target = 2;
  graph_.vertices[3].position = {5, 800};                        // a long way round
  others_.push_back({RobotId(1), {0.0, 0.0}, 0.0, 0.3, false});  // so that 0 is no free vertex
  const auto way = WaitForWay(RobotId(1), {1, 2, 1});
  ASSERT_TRUE(way);
  EXPECT_THAT(way->second.legs, ElementsAre(Leg{1, 4, 4}));
  ASSERT_TRUE(way->second.seconds_aside);
  EXPECT_GE(*way->second.seconds_aside, 4.0);
  EXPECT_LE(*way->second.seconds_aside, 8.0);
  others_.push_back({RobotId(2), {5.0, -3.0}, 0.0, 0.3, false});
  EXPECT_FALSE(WaitForWay(RobotId(1), {1, 2, 1})) << "no vertex is free";
}

// A robot that never moves is worth a longer way each time.
TEST_F(GivingWayTest, TakesALongerWayRoundARobotThatStays) {
  place_.vertex = 0;
  place_.target = 2;
  graph_.vertices[3].position = {5, 100};
  std::vector<double> closed;
  std::optional<WayAround> way;
  for (double time = 0.0; time < 60.0 && !way; time += 1.0) {
    now_.time = time;
    others_ = {{RobotId(1), {5.0, 0.0}, 0.0, 0.3, false}, {RobotId(2), {5.0, 100.0}, 0.0, 0.3, false}};
    std::optional<BlockEnd> end = giving_.OnBlocked(place_, RobotId(1), {0, 1, 0}, false);
    if (end && end->closed) closed.push_back(*end->closed);
    if (end) way = std::move(end->way);
  }
  ASSERT_TRUE(way);
  EXPECT_THAT(way->legs, ElementsAre(Leg{0, 3, 2}, Leg{3, 2, 3}));
  EXPECT_THAT(closed, ElementsAre(120.0, 240.0)) << "the first block is no news";
}

class ObstacleTest : public GivingWayTest {
 protected:
  // Each second from now on: the first end.
  std::optional<BlockEnd> Wait(const Leg& leg, double seconds, bool is_away = false, bool is_back_free = true) {
    for (double time = 0.0; time < seconds; time += 1.0, now_.time += 1.0) {
      if (std::optional<BlockEnd> end = giving_.OnObstacle(place_, leg, is_away, is_back_free)) return end;
    }
    return std::nullopt;
  }
};

TEST_F(ObstacleTest, ClosesTheLaneForItsRoutesUntilItHasPassed) {
  place_.target = 2;
  const std::optional<BlockEnd> end = Wait({0, 1, 0}, 10.0);
  ASSERT_TRUE(end && end->way);
  EXPECT_EQ(now_.time, 8.0);
  EXPECT_EQ(end->closed, 60.0);
  EXPECT_THAT(end->way->legs, ElementsAre(Leg{0, 3, 2}, Leg{3, 2, 3}));
  EXPECT_THAT(giving_.FindRoute(0, 2, 67.0)->legs, ElementsAre(Leg{0, 3, 2}, Leg{3, 2, 3}));
  EXPECT_THAT(giving_.FindRoute(0, 2, 68.0)->legs, ElementsAre(Leg{0, 1, 0}, Leg{1, 2, 1}));
  EXPECT_THAT(giving_.FindRoute(0, 4, 67.0)->legs, ElementsAre(Leg{0, 3, 2}, Leg{3, 2, 3}, Leg{2, 1, 1}, Leg{1, 4, 4}));
  now_.time = 100.0;
  EXPECT_EQ(Wait({0, 1, 0}, 10.0)->closed, 120.0);
  giving_.OnPassed(0);
  EXPECT_EQ(Wait({0, 1, 0}, 10.0)->closed, 60.0);
}

TEST_F(ObstacleTest, WaitsWithoutAnotherRouteAndAsksAgain) {
  place_.vertex = 1;
  place_.target = 4;
  std::optional<BlockEnd> end = Wait({1, 4, 4}, 10.0);
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->way);
  EXPECT_EQ(end->closed, 60.0);
  EXPECT_THAT(giving_.FindRoute(1, 4, now_.time)->legs, ElementsAre(Leg{1, 4, 4})) << "closed, and the only one";
  const double closed_at = now_.time;
  end = Wait({1, 4, 4}, 100.0);
  ASSERT_TRUE(end);
  EXPECT_EQ(now_.time, closed_at + 60.0);
  EXPECT_EQ(end->closed, 120.0);
  place_.target = 2;  // by a user, say
  end = Wait({1, 4, 4}, 1.0);
  ASSERT_TRUE(end && end->way);
  EXPECT_THAT(end->way->legs, ElementsAre(Leg{1, 2, 1}));
  EXPECT_FALSE(end->closed) << "it was said before";
}

TEST_F(ObstacleTest, TurnsBackOnItsLaneWhereItCan) {
  place_.target = 2;
  std::optional<BlockEnd> end = Wait({0, 1, 0}, 10.0, true);
  ASSERT_TRUE(end && end->way);
  EXPECT_TRUE(end->way->is_on_first);
  EXPECT_THAT(end->way->legs, ElementsAre(Leg{1, 0, 0}, Leg{0, 3, 2}, Leg{3, 2, 3}));
  end = Wait({0, 1, 0}, 10.0, true, false);
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->way) << "something is behind it";
  now_.time += 3.0;
  giving_.OnFree(now_.time);
  place_.target = 0;
  end = Wait({0, 1, 0}, 10.0, true);
  ASSERT_TRUE(end && end->way);
  EXPECT_THAT(end->way->legs, ElementsAre(Leg{1, 0, 0}));
  place_.target.reset();
  end = Wait({0, 1, 0}, 10.0, true);
  ASSERT_TRUE(end && end->way);
  EXPECT_THAT(end->way->legs, ElementsAre(Leg{1, 0, 0}));
  graph_.lanes[0].is_bidirectional = false;
  end = Wait({0, 1, 0}, 10.0, true);
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->way);
}

TEST_F(GivingWayTest, BeginsToWaitAnewWhenTheWayWasFree) {
  place_.vertex = 0;
  place_.target = 2;
  for (double time = 0.0; time < 40.0; time += 5.0) {
    now_.time = time;
    EXPECT_FALSE(giving_.OnBlocked(place_, RobotId(1), {0, 1, 0}, false));
    giving_.OnFree(time);
  }
}

TEST_F(GivingWayTest, LeavesNoCabinForOthers) {
  graph_.vertices[0].lift = 0;
  place_.vertex = 0;
  place_.target = 2;
  EXPECT_FALSE(WaitForWay(RobotId(1), {0, 1, 0}));
}

TEST_F(GivingWayTest, IsAskedForRoomByRobotsThatStandNear) {
  now_.pose_estimate = {5.0, 0.0, 0.0, 0.0};
  const auto asks = [&](double x, double y, double z, bool moves, const Vec2& towards) {
    others_ = {{RobotId(1), {x, y}, z, 0.3, moves}};
    return GivingWay::IsAskedForRoom(place_, towards);
  };
  EXPECT_TRUE(asks(6.0, 0.0, 0.0, false, Vec2::Zero()));
  EXPECT_TRUE(asks(4.0, 0.0, 0.0, false, Vec2::Zero()));
  EXPECT_FALSE(asks(4.0, 0.0, 0.0, false, {1.0, 0.0})) << "behind it";
  EXPECT_FALSE(asks(6.5, 0.0, 0.0, false, Vec2::Zero())) << "too far away";
  EXPECT_FALSE(asks(6.0, 0.0, 4.0, false, Vec2::Zero())) << "on another level";
  EXPECT_FALSE(asks(6.0, 0.0, 0.0, true, Vec2::Zero()));
}

}  // namespace
}  // namespace troupe
