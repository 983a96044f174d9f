#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "robot-agent/ros/gripper_action.h"
#include "ros/messages/text_messages.h"
#include "tests/support/gripper_world.h"

namespace troupe {
namespace {

constexpr std::int64_t kIntervalNs = 100'000'000;
constexpr double kMaxGripperOpening = 0.3;  // m

GoalId Id(std::uint8_t number) {
  GoalId id{};
  id[15] = number;
  return id;
}

// The goals of a gripper whose motion the test states.
class GripperGoalsTest : public testing::Test {
 protected:
  // A tick: an order follows its state and has its effect in the next tick.
  std::optional<GripperGoals::Order> Tick() { return goals_.Begin(tick_++); }
  void See(double opening, bool moves = true, bool blocked = false, bool clamped = false) {
    goals_.Observe(tick_, {.opening = opening, .moves = moves, .blocked = blocked, .clamped = clamped});
  }
  GoalStatus StatusOf(std::uint8_t number) const {
    const GripperGoal* goal = goals_.Find(Id(number));
    return goal == nullptr ? GoalStatus::kUnknown : goal->status;
  }
  CancelAnswer Cancel(const GoalId& id, std::int64_t stamp = 0) {
    ros::CancelResult<GripperGoal> result = goals_.Cancel(id, stamp);
    canceling_ = std::move(result.canceling);
    return result.answer;
  }

  GripperGoals goals_{kMaxGripperOpening, kMaxGripperOpening, kIntervalNs};
  troupe::Tick tick_ = 0;
  std::vector<GripperGoal> canceling_;
};

TEST_F(GripperGoalsTest, ReachAnOpening) {
  EXPECT_FALSE(Tick());
  ASSERT_TRUE(goals_.Accept(Id(1), 0.1, 5.0));
  EXPECT_EQ(StatusOf(1), GoalStatus::kAccepted);
  const auto order = Tick();
  ASSERT_TRUE(order);
  EXPECT_EQ(order->opening, 0.1);
  EXPECT_EQ(StatusOf(1), GoalStatus::kExecuting);
  See(0.2);
  EXPECT_EQ(goals_.executing()->position, 0.2);
  EXPECT_FALSE(Tick());
  See(0.1);
  const GripperGoal goal = *goals_.Find(Id(1));
  EXPECT_EQ(goal.status, GoalStatus::kSucceeded);
  EXPECT_TRUE(goal.reached);
  EXPECT_FALSE(goal.stalled);
  EXPECT_EQ(goal.position, 0.1);
  EXPECT_EQ(goals_.executing(), nullptr);
}

TEST_F(GripperGoalsTest, SucceedOnAnObjectAndAbortOnAnObstacle) {
  goals_.Accept(Id(1), 0.0, 0.0);
  Tick();
  See(0.1, false, true, true);
  EXPECT_EQ(StatusOf(1), GoalStatus::kSucceeded);
  EXPECT_TRUE(goals_.Find(Id(1))->stalled);
  EXPECT_FALSE(goals_.Find(Id(1))->reached);

  goals_.Accept(Id(2), 0.0, 0.0);
  Tick();
  See(0.1, true, true);  // one finger still moves
  EXPECT_EQ(StatusOf(2), GoalStatus::kExecuting);
  Tick();
  See(0.05, false, true);
  EXPECT_EQ(StatusOf(2), GoalStatus::kAborted);
  EXPECT_TRUE(goals_.Find(Id(2))->stalled);
}

TEST_F(GripperGoalsTest, WaitASecondForFingersThatDoNotMove) {
  See(kMaxGripperOpening, false);
  goals_.Accept(Id(1), 0.0, 0.0);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(StatusOf(1), i == 0 ? GoalStatus::kAccepted : GoalStatus::kExecuting) << i;
    Tick();
    See(kMaxGripperOpening, false);
  }
  EXPECT_EQ(StatusOf(1), GoalStatus::kAborted);
}

TEST_F(GripperGoalsTest, AreJudgedOnlyByLaterObservations) {
  See(0.0, false, true, true);
  goals_.Accept(Id(1), 0.2, 0.0);
  goals_.Begin(tick_);
  See(0.0, false, true, true);  // the same tick again
  EXPECT_EQ(StatusOf(1), GoalStatus::kExecuting);
}

TEST_F(GripperGoalsTest, RefuseImpossibleOpenings) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double opening : {std::nan(""), kInfinity, -kInfinity, -0.01, 0.301}) {
    EXPECT_FALSE(goals_.Accept(Id(1), opening, 0.0)) << opening;
  }
  EXPECT_FALSE(goals_.Accept(Id(1), 0.1, std::nan("")));
  EXPECT_TRUE(goals_.Accept(Id(1), 0.3, 0.0));
  EXPECT_FALSE(goals_.Accept(Id(1), 0.3, 0.0)) << "an id twice";
  EXPECT_EQ(goals_.goals().all().size(), 1u);
}

TEST_F(GripperGoalsTest, AreReplacedByTheNewest) {
  goals_.Accept(Id(1), 0.1, 0.0);
  Tick();
  See(0.2);
  goals_.Accept(Id(2), 0.2, 0.0);
  goals_.Accept(Id(3), 0.3, 0.0);
  EXPECT_EQ(Tick()->opening, 0.3);
  EXPECT_EQ(StatusOf(1), GoalStatus::kAborted);
  EXPECT_EQ(goals_.Find(Id(1))->position, 0.2);
  EXPECT_EQ(StatusOf(2), GoalStatus::kAborted);
  EXPECT_EQ(StatusOf(3), GoalStatus::kExecuting);
  goals_.AbortAll();
  EXPECT_EQ(StatusOf(3), GoalStatus::kAborted);
}

TEST_F(GripperGoalsTest, StopTheFingersWhenCancelled) {
  goals_.Accept(Id(1), 0.0, 0.0);
  Tick();
  See(0.2);
  EXPECT_EQ(Cancel(Id(1)), CancelAnswer::kNone);
  ASSERT_EQ(canceling_.size(), 1u);
  EXPECT_EQ(StatusOf(1), GoalStatus::kCanceling);
  See(0.2);
  EXPECT_EQ(StatusOf(1), GoalStatus::kCanceling) << "the order to stop was not sent yet";
  const auto order = Tick();
  ASSERT_TRUE(order);
  EXPECT_FALSE(order->opening);
  See(0.2, false);
  EXPECT_EQ(StatusOf(1), GoalStatus::kCanceled);
  EXPECT_EQ(goals_.Find(Id(1))->position, 0.2);
  EXPECT_EQ(Cancel(Id(1)), CancelAnswer::kGoalHasEnded);
  EXPECT_EQ(Cancel(Id(9)), CancelAnswer::kUnknownGoal);
}

TEST_F(GripperGoalsTest, AreCancelledByIdByStampOrAll) {
  goals_.Accept(Id(1), 0.0, 0.0);
  tick_ = 5;
  See(0.3);
  goals_.Accept(Id(2), 0.0, 0.0);
  EXPECT_EQ(Cancel(GoalId{}, 4 * kIntervalNs), CancelAnswer::kNone);
  ASSERT_EQ(canceling_.size(), 1u);
  EXPECT_EQ(canceling_[0].id, Id(1));
  EXPECT_EQ(Cancel(GoalId{}), CancelAnswer::kNone);
  ASSERT_EQ(canceling_.size(), 1u);
  EXPECT_EQ(canceling_[0].id, Id(2));
  EXPECT_EQ(canceling_[0].stamp, 5 * kIntervalNs);
  EXPECT_EQ(Cancel(GoalId{}), CancelAnswer::kNone);
  EXPECT_TRUE(canceling_.empty());
}

TEST_F(GripperGoalsTest, AreRemovedSomeTimeAfterTheirEnd) {
  for (int i = 1; i <= 40; ++i) {
    ASSERT_TRUE(goals_.Accept(Id(static_cast<std::uint8_t>(i)), 0.1, 0.0));
    Tick();
    See(0.1);
  }
  See(0.1);
  EXPECT_EQ(goals_.goals().all().size(), 16u);
  EXPECT_EQ(StatusOf(1), GoalStatus::kUnknown);
  EXPECT_EQ(StatusOf(40), GoalStatus::kSucceeded);
  for (int i = 50; i < 250; ++i) goals_.Accept(Id(static_cast<std::uint8_t>(i)), 0.1, 0.0);
  EXPECT_EQ(goals_.goals().all().size(), 116u);
}

}  // namespace

}  // namespace troupe

namespace troupe::ros {
namespace {

class GripperStateTest : public testing::Test {
 protected:
  GripperStateTest() : parts_(world_.AddGripperRobot({})), box_(world_.AddObject({0.35, 0.0, 0.0, 0.0})) {}
  nlohmann::json Json(const WorldState& state) const {
    return nlohmann::json::parse(GripperJson(world_.world, parts_.gripper, state));
  }

  test::GripperWorld world_;
  test::GripperRobot parts_;
  ObjectId box_;
};

TEST_F(GripperStateTest, ReportsTheMotionOfTheFingers) {
  WorldState state = PlacedState(world_.world);
  EXPECT_EQ(Json(state), nlohmann::json({{"tick", 0},
                                         {"fingers", "open"},
                                         {"opening", 0.3},
                                         {"largest_opening", 0.3},
                                         {"lift", 0.0},
                                         {"lift_blocked", false}}));
  state.joints[parts_.left.index()] = {0.05, 0.5, false};
  EXPECT_EQ(Json(state)["fingers"], "closing");
  EXPECT_NEAR(Json(state)["opening"].get<double>(), 0.25, 1e-12);
  state.joints[parts_.left.index()] = {0.05, -0.5, false};
  EXPECT_EQ(Json(state)["fingers"], "opening");
  state.joints[parts_.left.index()] = {0.05, 0.0, true};
  EXPECT_EQ(Json(state)["fingers"], "closed");
  const GripperMotion motion = MotionOf(world_.world, parts_.gripper, state);
  EXPECT_FALSE(motion.moves);
  EXPECT_TRUE(motion.blocked);
}

TEST_F(GripperStateTest, ReportsTheHeldObject) {
  test::GripperRun run(world_.world);
  run.Step({{.fingers = 0.5}}, 5);
  ASSERT_TRUE(run.state.objects[box_.index()].holder);
  const std::string name = world_.model(world_.world.objects[0]).name;
  const nlohmann::json json = Json(run.state);
  for (const char* key : {"held", "clamped", "left_contact", "right_contact"}) EXPECT_EQ(json[key], name) << key;
  EXPECT_NEAR(json["opening"].get<double>(), 0.1, 1e-9);
  EXPECT_EQ(json["fingers"], "closed");

  WorldState state = run.state;
  state.objects[box_.index()].holder.reset();
  EXPECT_FALSE(Json(state).contains("held"));
  EXPECT_TRUE(Json(state).contains("clamped"));
}

}  // namespace
}  // namespace troupe::ros
