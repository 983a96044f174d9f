#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "launcher/commands/commands.h"
#include "launcher/driving/robot_remote.h"

namespace troupe {
namespace {

TEST(TeleopKeysTest, KeysMoveForAWhileAfterTheirLastRepetition) {
  TeleopKeys keys({.speed = 0.5, .turn_rate = 1.0, .hold_seconds = 0.7});
  EXPECT_TRUE(keys.TwistAt(0.0).IsZero());
  EXPECT_TRUE(keys.Press("w", 10.0));
  EXPECT_EQ(keys.TwistAt(10.6), (Twist{0.5, 0.0, 0.0}));
  EXPECT_TRUE(keys.TwistAt(10.8).IsZero());
  EXPECT_TRUE(keys.Press("ww", 11.0));
  EXPECT_TRUE(keys.Press("w", 11.5));
  EXPECT_EQ(keys.TwistAt(12.1).vx, 0.5);
  EXPECT_TRUE(keys.Press("s", 12.1));
  EXPECT_EQ(keys.TwistAt(12.2).vx, -0.5);
}

TEST(TeleopKeysTest, DirectionsAddUp) {
  TeleopKeys keys({.speed = 0.5, .turn_rate = 1.0, .hold_seconds = 0.7});
  EXPECT_TRUE(keys.Press("waq", 0.0));
  EXPECT_EQ(keys.TwistAt(0.1), (Twist{0.5, 0.5, 1.0}));
  EXPECT_TRUE(keys.Press("de", 0.1));
  EXPECT_EQ(keys.TwistAt(0.2), (Twist{0.5, -0.5, -1.0}));
  EXPECT_TRUE(keys.Press(" ", 0.2));
  EXPECT_TRUE(keys.TwistAt(0.2).IsZero());
}

TEST(TeleopKeysTest, ArrowsMayArriveInPieces) {
  TeleopKeys keys({});
  EXPECT_TRUE(keys.Press("\033", 0.0));
  EXPECT_TRUE(keys.Press("[", 0.0));
  EXPECT_TRUE(keys.TwistAt(0.1).IsZero());
  EXPECT_TRUE(keys.Press("A\033OD", 0.0));
  EXPECT_EQ(keys.TwistAt(0.1), (Twist{0.5, 0.0, 1.0}));
  // Other sequences, and letters within them, are no keys.
  EXPECT_TRUE(keys.Press(" \033[3~\033[1;5x\033[15~\033Z", 0.0));
  EXPECT_TRUE(keys.TwistAt(0.1).IsZero());
  EXPECT_TRUE(keys.Press("w", 0.0));
  EXPECT_EQ(keys.TwistAt(0.1).vx, 0.5);
}

TEST(TeleopKeysTest, SpeedsAreScaledWithinBounds) {
  TeleopKeys keys({.speed = 0.5, .turn_rate = 1.0, .hold_seconds = 1.0});
  EXPECT_TRUE(keys.Press("w+=", 0.0));
  EXPECT_DOUBLE_EQ(keys.TwistAt(0.1).vx, 0.5 * 1.25 * 1.25);
  EXPECT_TRUE(keys.Press("---", 0.0));
  EXPECT_DOUBLE_EQ(keys.TwistAt(0.1).vx, 0.4);
  EXPECT_TRUE(keys.Press(std::string(1000, '+'), 0.0));
  EXPECT_EQ(keys.TwistAt(0.1).vx, 100.0);
}

TEST(TeleopKeysTest, OrdersToTheGripperAreGivenOnce) {
  TeleopKeys keys({});
  EXPECT_FALSE(keys.DrainOrder());
  EXPECT_TRUE(keys.Press("c", 0.0));
  EXPECT_TRUE(keys.Press("r", 0.0));
  EXPECT_EQ(keys.DrainOrder(), (GripperOrder{0, 0.0, 100.0}));
  EXPECT_FALSE(keys.DrainOrder());
  EXPECT_TRUE(keys.Press("of", 0.0));
  EXPECT_EQ(keys.DrainOrder(), (GripperOrder{0, 100.0, 0.0}));
}

TEST(TeleopKeysTest, XAndCtrlDEnd) {
  TeleopKeys keys({});
  EXPECT_FALSE(keys.Press("wx", 0.0));
  EXPECT_FALSE(keys.Press("\004", 0.0));
  EXPECT_TRUE(keys.Press(std::string("\0\177zZ", 4), 0.0));
}

TEST(GoalTextTest, ReadsPointsAndAHeading) {
  const Result<Goal> goal = ParseGoalText({"1,-2.5", "3e0,4,-90"});
  ASSERT_TRUE(goal.ok());
  EXPECT_EQ(goal.value().waypoints, (std::vector<Vec2>{{1.0, -2.5}, {3.0, 4.0}}));
  EXPECT_NEAR(*goal.value().heading, -1.5707963267948966, 1e-15);
  EXPECT_FALSE(ParseGoalText({"1,2"}).value().heading);
  for (const char* text : {"", "1", "1,", ",1", "1,2,3,4", "1;2", "1,2 ", "inf,1", "1,0x2", "a,b"}) {
    EXPECT_FALSE(ParseGoalText({text}).ok()) << text;
  }
}

}  // namespace
}  // namespace troupe
