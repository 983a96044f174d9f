// Grippers and joints commanded from ROS: an agent's replica in a stepped world, and a ROS node as its peer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "robot-agent/agent/replica.h"
#include "robot-agent/ros/ros_gateway.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/messages/action_goals.h"
#include "tests/support/gripper_world.h"
#include "tests/support/host_participant.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"

namespace troupe::test {
namespace {

using SendGoal = Client<control_msgs_action_dds__GripperCommand_SendGoal_Request_,
                        control_msgs_action_dds__GripperCommand_SendGoal_Response_>;
using GetResult = Client<control_msgs_action_dds__GripperCommand_GetResult_Request_,
                         control_msgs_action_dds__GripperCommand_GetResult_Response_>;
using CancelGoal = Client<action_msgs_srv_dds__CancelGoal_Request_, action_msgs_srv_dds__CancelGoal_Response_>;
using Feedback = control_msgs_action_dds__GripperCommand_FeedbackMessage_;
using Statuses = action_msgs_msg_dds__GoalStatusArray_;
using Uuid = unique_identifier_msgs_msg_dds__UUID_;

constexpr double kMaxOpening = 0.3;  // m, opening of the gripper

// A robot with a gripper, an arm that turns, and a box of 0.1 m between its fingers. Fingers move 0.01 m in a tick, the
// lift 0.05 m.
GripperWorld MakeWorld() {
  GripperWorld world;
  const GripperRobot parts = world.AddGripperRobot({});
  world.model(parts.root).name = world.world.robots[0].name = "a";
  const ModelId arm = world.AddModel(std::vector<Block>(), {}, parts.root);
  world.AddJoint(parts.robot, arm, {0.0, 0.0}, 1.0, {-1.0, 1.0});
  world.world.joints.back().type = JointType::kRevolute;
  const char* names[] = {"gripper.lift", "gripper.left", "gripper.right", "arm"};
  const double speeds[] = {0.5, 0.1, 0.1, 1.0};
  for (std::size_t i = 0; i < 4; ++i) {
    world.world.joints[i].name = names[i];
    world.world.joints[i].max_speed = speeds[i];
    if (i == 3) world.world.joints[i].start = 0.0;
  }
  world.AddObject({0.35, 0.0, 0.0, 0.0});
  return world;
}

class ManipulatorPortTest : public testing::Test {
 protected:
  ManipulatorPortTest() {
    ros::RosOptions options = {.network = TestRosNetwork()};
    options.socket = host_.socket();
    Result<std::unique_ptr<Replica>> replica =
        Replica::Create(std::make_shared<const Scene>(world_.world), {}, {}, {}, MakeRosGateway(options));
    replica_ = std::move(replica).value();
  }

  // A tick of the agent and of its world.
  void Tick(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      const ProposalMessage answer = replica_->Decide(state_);
      replica_->Publish(state_);
      state_ = Step(scene_, state_, answer.proposals).state;
      reports_.insert(reports_.end(), answer.reports.begin(), answer.reports.end());
    }
  }
  // The end of a step from a pause: the state is published and no proposal computed.
  void Pause() {
    replica_->Pause(state_);
    replica_->Publish(state_);
  }

  // Sends the command once, and ticks until `obeyed`.
  template <typename Obeyed>
  void Command(const std::string& topic, double value, const Obeyed& obeyed) {
    dds::Topic<ros::Float64> name(participant_.participant(), "rt" + topic);
    dds::DataWriter<ros::Float64> writer(participant_.publisher(), name, ros::ToDds(ros::Stream(1)));
    ASSERT_TRUE(Eventually([&] { return writer.publication_matched_status().current_count > 0; }));
    writer.write({value});
    ASSERT_TRUE(writer.wait_for_acknowledgments(20.0));
    EXPECT_TRUE(Eventually([&] {
      Tick();
      return obeyed();
    }));
  }

  bool SendGoalOf(double opening, std::uint8_t id, double effort = 0.0) {
    control_msgs_action_dds__GripperCommand_SendGoal_Request_ request{};
    request.goal_id = IdOf(id);
    request.goal.command = {opening, effort};
    bool accepted = false;
    send_goal_.Call(request, [&](const auto& response) { accepted = response.accepted; });
    return accepted;
  }
  void AskForResultOf(std::uint8_t id) {
    control_msgs_action_dds__GripperCommand_GetResult_Request_ request{};
    request.goal_id = IdOf(id);
    get_result_.Send(request);
  }
  // Ticks until the requested result arrives.
  control_msgs_action_dds__GripperCommand_GetResult_Response_ ResultAfterTicks() {
    control_msgs_action_dds__GripperCommand_GetResult_Response_ result{};
    EXPECT_TRUE(Eventually([&] {
      Tick();
      return get_result_.Receive([&](const auto& response) { result = response; });
    }));
    return result;
  }
  static Uuid IdOf(std::uint8_t number) {
    Uuid id{};
    id.uuid[0] = number;
    return id;
  }
  double position(std::size_t joint) const { return state_.joints[joint].position; }
  double opening() const { return kMaxOpening - position(1) - position(2); }

  HostParticipant host_;
  ros::RosParticipant participant_{TestRosNetwork()};
  ros::RosNode peer_ = ros::MakeNode(participant_, "/", "peer");
  GripperWorld world_ = MakeWorld();
  Scene scene_{world_.world};
  WorldState state_ = PlacedState(world_.world);
  std::unique_ptr<Replica> replica_;
  SendGoal send_goal_{participant_, "/a/gripper/gripper_cmd/_action/send_goal"};
  GetResult get_result_{participant_, "/a/gripper/gripper_cmd/_action/get_result"};
  CancelGoal cancel_goal_{participant_, "/a/gripper/gripper_cmd/_action/cancel_goal"};
  std::vector<std::string> reports_;
};

TEST_F(ManipulatorPortTest, ObeysPositionsOfFingersLiftAndJoints) {
  Command("/a/gripper/command", 0.2, [&] { return opening() < 0.2 + 1e-9; });
  EXPECT_NEAR(opening(), 0.2, 1e-9);
  EXPECT_NEAR(position(1), position(2), 1e-12);
  Command("/a/gripper/lift/command", 0.25, [&] { return position(0) >= 0.25; });
  EXPECT_EQ(position(0), 0.25);
  Command("/a/arm/command", -0.5, [&] { return position(3) <= -0.5; });
  EXPECT_EQ(position(3), -0.5);
  Command("/a/gripper/command", 1e30, [&] { return opening() >= kMaxOpening; });
  Command("/a/arm/command", 7.0, [&] { return position(3) >= 1.0; });
  Tick(3);
  EXPECT_EQ(position(3), 1.0) << "bounded";
  EXPECT_THAT(reports_, testing::IsEmpty());
}

TEST_F(ManipulatorPortTest, IgnoresPositionsThatAreNotFiniteAndSaysSo) {
  const double kInfinity = std::numeric_limits<double>::infinity();
  for (const char* topic : {"/a/gripper/command", "/a/gripper/lift/command", "/a/arm/command"}) {
    const std::size_t before = reports_.size();
    Command(topic, topic[3] == 'g' ? std::nan("") : kInfinity, [&] { return reports_.size() > before; });
  }
  Tick(3);
  EXPECT_EQ(state_.joints, PlacedState(world_.world).joints);
  EXPECT_THAT(reports_, testing::ElementsAre("/a/gripper/command: ignored a command that is not finite (1 so far)",
                                             "/a/gripper/lift/command: ignored a command that is not finite (1 so far)",
                                             "/a/arm/command: ignored a command that is not finite (1 so far)"));
}

TEST_F(ManipulatorPortTest, PublishesTheStateOfAGripper) {
  ros::RosReader<ros::String> states(peer_, "/a/gripper/state", ros::Stream(10));
  nlohmann::json last;
  Command("/a/gripper/command", 0.0, [&] {
    states.Drain([&](const ros::String& message) { last = nlohmann::json::parse(message.data); });
    return last.contains("held");
  });
  EXPECT_EQ(last["held"], world_.model(world_.world.objects[0]).name);
  EXPECT_NEAR(last["opening"].get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(opening(), 0.1, 1e-9);
}

TEST_F(ManipulatorPortTest, ServesAGoalUntilItIsReached) {
  ros::RosReader<Feedback> feedback(peer_, "/a/gripper/gripper_cmd/_action/feedback", ros::Stream(100));
  ros::RosReader<Statuses> status(peer_, "/a/gripper/gripper_cmd/_action/status", ros::Latched());
  std::vector<double> positions;
  std::vector<int> statuses;
  ASSERT_TRUE(SendGoalOf(0.2, 1));
  Tick();
  EXPECT_EQ(opening(), kMaxOpening - 0.02) << "from the next tick on";
  AskForResultOf(1);
  const auto response = ResultAfterTicks();
  EXPECT_EQ(response.status, 4);
  EXPECT_NEAR(response.result.position, 0.2, 1e-9);
  EXPECT_EQ(response.result.effort, 0.0);
  EXPECT_TRUE(response.result.reached_goal);
  EXPECT_FALSE(response.result.stalled);
  EXPECT_TRUE(Eventually([&] {
    feedback.Drain([&](const Feedback& message) {
      EXPECT_EQ(message.goal_id.uuid[0], 1);
      positions.push_back(message.feedback.position);
    });
    status.Drain([&](const Statuses& message) {
      ASSERT_EQ(message.status_list._length, 1u);
      statuses.push_back(message.status_list._buffer[0].status);
    });
    return !positions.empty() && !statuses.empty() && statuses.back() == 4;
  }));
  EXPECT_TRUE(std::is_sorted(positions.rbegin(), positions.rend()));
  EXPECT_NEAR(positions.back(), 0.2, 1e-9);
  AskForResultOf(1);
  EXPECT_EQ(ResultAfterTicks().status, 4) << "for a late request";
  AskForResultOf(77);
  EXPECT_EQ(ResultAfterTicks().status, 0) << "an unknown goal";
}

TEST_F(ManipulatorPortTest, EndsAGoalOnAnObjectWithSuccess) {
  ASSERT_TRUE(SendGoalOf(0.0, 1));
  AskForResultOf(1);
  const auto response = ResultAfterTicks();
  EXPECT_EQ(response.status, 4);
  EXPECT_TRUE(response.result.stalled);
  EXPECT_FALSE(response.result.reached_goal);
  EXPECT_NEAR(response.result.position, 0.1, 1e-9);
  EXPECT_TRUE(state_.objects[0].holder);
}

TEST_F(ManipulatorPortTest, RefusesGoalsOutOfLimitsAndSaysSo) {
  for (const double opening : {std::nan(""), -0.1, 0.31, std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(SendGoalOf(opening, 1)) << opening;
  }
  EXPECT_FALSE(SendGoalOf(0.1, 1, std::nan("")));
  Tick(2);
  EXPECT_EQ(opening(), kMaxOpening);
  ASSERT_EQ(reports_.size(), 1u);
  EXPECT_EQ(reports_[0], "/a/gripper/gripper_cmd: refused a goal of 0.1 m, expected 0 to 0.3 (5 so far)");
}

TEST_F(ManipulatorPortTest, StopsTheFingersWhenAGoalIsCancelled) {
  ASSERT_TRUE(SendGoalOf(0.15, 1));
  Tick(3);
  action_msgs_srv_dds__CancelGoal_Request_ request{};
  request.goal_info.goal_id = IdOf(1);
  cancel_goal_.Call(request, [&](const auto& response) {
    EXPECT_EQ(response.return_code, 0);
    ASSERT_EQ(response.goals_canceling._length, 1u);
    EXPECT_EQ(response.goals_canceling._buffer[0].goal_id.uuid[0], 1);
  });
  const double then = opening();
  AskForResultOf(1);
  const auto response = ResultAfterTicks();
  EXPECT_EQ(response.status, 5);
  EXPECT_NEAR(response.result.position, then, 1e-12);
  Tick(3);
  EXPECT_EQ(opening(), then);
  cancel_goal_.Call(request, [](const auto& answer) { EXPECT_EQ(answer.return_code, 3); });
  request.goal_info.goal_id = IdOf(9);
  cancel_goal_.Call(request, [](const auto& answer) { EXPECT_EQ(answer.return_code, 2); });
}

TEST_F(ManipulatorPortTest, AGoalSentInAPauseStartsWithTheStep) {
  Pause();
  ASSERT_TRUE(SendGoalOf(0.28, 1));
  AskForResultOf(1);
  Pause();
  EXPECT_FALSE(get_result_.Receive([](const auto&) {}));
  EXPECT_EQ(opening(), kMaxOpening);
  const ProposalMessage answer = replica_->Decide(state_);
  state_ = Step(scene_, state_, answer.proposals).state;
  Pause();
  EXPECT_NEAR(opening(), 0.28, 1e-12);
  EXPECT_TRUE(
      Eventually([&] { return get_result_.Receive([](const auto& response) { EXPECT_EQ(response.status, 4); }); }));
}

TEST_F(ManipulatorPortTest, ACommandOnTheTopicEndsAGoal) {
  ASSERT_TRUE(SendGoalOf(0.15, 1));
  Tick(2);
  Command("/a/gripper/command", kMaxOpening, [&] { return opening() == kMaxOpening; });
  AskForResultOf(1);
  EXPECT_EQ(ResultAfterTicks().status, 6);
}

// As by a reset.
TEST_F(ManipulatorPortTest, AGoalThatIsUnderWayIsAbortedWhenTheRobotEnds) {
  ASSERT_TRUE(SendGoalOf(0.0, 1));
  AskForResultOf(1);
  action_msgs_srv_dds__CancelGoal_Request_ unknown{};
  unknown.goal_info.goal_id = IdOf(9);
  cancel_goal_.Call(unknown, [](const auto&) {});  // so that the call before has arrived
  Tick();
  replica_.reset();
  control_msgs_action_dds__GripperCommand_GetResult_Response_ result{};
  EXPECT_TRUE(Eventually([&] { return get_result_.Receive([&](const auto& response) { result = response; }); }));
  EXPECT_EQ(ros::GoalStatus(result.status), ros::GoalStatus::kAborted);
}

}  // namespace
}  // namespace troupe::test
