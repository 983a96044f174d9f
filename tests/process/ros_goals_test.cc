// Goals and calls from ROS end, whatever becomes of the robot, its agent, the world service or ros-participant: rows of
// the table "Goals and calls end" of docs/ros2.md.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <optional>
#include <string>
#include <vector>

#include "ros/connection/topic_types.h"
#include "ros/messages/action_goals.h"
#include "tests/process/programs.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"

namespace troupe::test {
namespace {

using ros::GoalStatus;
using testing::HasSubstr;

// A program of ROS.
class Caller {
 public:
  // `id` tells callers in one domain apart.
  explicit Caller(std::uint64_t id = 4711) : id_(id) {}

  // False: it is refused.
  bool SendGoal(std::uint8_t id) {
    control_msgs_action_dds__GripperCommand_SendGoal_Request_ request{};
    request.goal_id.uuid[0] = id;
    request.goal.command.position = 0.1;
    bool accepted = false;
    send_goal_.Call(request, [&](const auto& response) { accepted = response.accepted; });
    return accepted;
  }
  void AskForResult(std::uint8_t id) {
    control_msgs_action_dds__GripperCommand_GetResult_Request_ request{};
    request.goal_id.uuid[0] = id;
    get_result_.Send(request);
    get_result_.AwaitArrival();
  }
  // A goal without an end in a pause, and a call for its result. The server knows the caller's endpoints by then, from
  // its answer to a call for the result of a goal that does not exist.
  void OpenGoal(std::uint8_t id) {
    AskForResult(0);
    ASSERT_EQ(AwaitResult(), GoalStatus::kUnknown);
    ASSERT_TRUE(SendGoal(id));
    AskForResult(id);
  }
  GoalStatus AwaitResult() {
    GoalStatus status = GoalStatus::kUnknown;
    EXPECT_TRUE(Eventually(
        [&] { return get_result_.Receive([&](const auto& response) { status = GoalStatus(response.status); }); }));
    return status;
  }

  const std::uint64_t id_;
  ros::RosParticipant participant_{TestRosNetwork()};
  Client<rcl_interfaces_srv_dds__ListParameters_Request_, rcl_interfaces_srv_dds__ListParameters_Response_> list_{
      participant_, "/a/robot/list_parameters", id_};
  TROUPE_SIMULATION_CLIENT(StepSimulation) step_{participant_, "/world/step_simulation", id_};
  Client<simulation_interfaces_action_dds__SimulateSteps_SendGoal_Request_,
         simulation_interfaces_action_dds__SimulateSteps_SendGoal_Response_>
      simulate_{participant_, "/world/simulate_steps/_action/send_goal", id_};

 private:
  Client<control_msgs_action_dds__GripperCommand_SendGoal_Request_,
         control_msgs_action_dds__GripperCommand_SendGoal_Response_>
      send_goal_{participant_, "/a/gripper/gripper_cmd/_action/send_goal", id_};
  Client<control_msgs_action_dds__GripperCommand_GetResult_Request_,
         control_msgs_action_dds__GripperCommand_GetResult_Response_>
      get_result_{participant_, "/a/gripper/gripper_cmd/_action/get_result", id_};
};

class RosGoals : public testing::Test {
 protected:
  Program RunPaused() {
    Program run = Troupe(Words("run % --headless --paused --speed 10 --lease 5 --record % --session % --domain %",
                               {file_, folder_.Path("run.mcap"), session_, std::to_string(TestDomain())}) +
                         RosArguments({}));
    run.WaitForLine(", ready");
    return run;
  }
  void Call(const control::Request& request) {
    const ControlReply reply = CallRun(session_, request);
    EXPECT_TRUE(reply.done) << reply.problem;
  }
  static pid_t ChildOf(const Program& run, const std::string& part) {
    const std::vector<pid_t> children = ChildrenWith(run, part);
    EXPECT_EQ(children.size(), 1u) << part;
    return children.empty() ? 0 : children.front();
  }

  TemporaryFolder folder_;
  const std::string file_ = folder_.Write("goals.world", R"(
    define rover position
    (
      size [0.4 0.4 0.3]  drive "diff"
      gripper( name "gripper" pose [0.3 0 -0.3 0] )
    )
    rover( name "a" )
    rover( name "b" pose [0 3 0 0] )
  )");
  const std::string session_ = TestSession("goals");
};

TEST_F(RosGoals, AreAbortedByAResetAnEditAndADeletion) {
  Program run = RunPaused();
  Caller caller;
  caller.OpenGoal(1);
  Call(control::Reset());
  EXPECT_EQ(caller.AwaitResult(), GoalStatus::kAborted);
  caller.OpenGoal(2);
  Call(control::Spawn{.source = "rover", .name = "late", .pose = {0.0, 6.0, 0.0, 0.0}});
  EXPECT_EQ(caller.AwaitResult(), GoalStatus::kAborted);
  caller.OpenGoal(3);
  Call(control::Delete{.name = "a"});
  EXPECT_EQ(caller.AwaitResult(), GoalStatus::kAborted);
  run.Interrupt();
}

TEST_F(RosGoals, GoOnAfterAMove) {
  Program run = RunPaused();
  Caller caller;
  caller.OpenGoal(1);
  Call(control::SetPose{.name = "a", .pose = {0.0, -2.0, 0.0, 0.0}});
  Call(control::Play());
  EXPECT_EQ(caller.AwaitResult(), GoalStatus::kSucceeded);
  run.Interrupt();
}

TEST_F(RosGoals, OfAnAgentThatDiesAreAbortedAndItsCallsAnsweredByTheNextOne) {
  Program run = RunPaused();
  Caller caller;
  caller.OpenGoal(1);
  const pid_t agent = ChildOf(run, "--robot=a ");
  kill(agent, SIGSTOP);
  caller.list_.Send({});
  caller.list_.AwaitArrival();
  kill(agent, SIGKILL);
  EXPECT_EQ(caller.AwaitResult(), GoalStatus::kAborted);
  EXPECT_TRUE(Eventually([&] {
    return caller.list_.Receive([](const auto& response) {
      EXPECT_THAT(dds::Strings(response.result.names), testing::Contains("use_sim_time"));
    });
  }));
  run.Interrupt();
}

TEST_F(RosGoals, OfASimulationWhoseServiceDiesAreRefused) {
  Program run = RunPaused();
  Caller caller;
  // A request waits until its server knows the reader of its answer. One that waits longer than the service lives is
  // new to the next service, which carries it out.
  StepBy(caller.step_, 1);
  caller.simulate_.Call({}, [](const auto&) {});
  const pid_t service = ChildOf(run, "/world-service ");
  kill(service, SIGSTOP);
  simulation_interfaces_srv_dds__StepSimulation_Request_ million{};
  million.steps = 1'000'000;
  caller.step_.Send(million);
  simulation_interfaces_action_dds__SimulateSteps_SendGoal_Request_ goal{};
  goal.goal.steps = 1'000'000;
  caller.simulate_.Send(goal);
  caller.step_.AwaitArrival();
  caller.simulate_.AwaitArrival();
  kill(service, SIGKILL);
  EXPECT_TRUE(Eventually([&] {
    return caller.step_.Receive([](const auto& response) {
      EXPECT_EQ(response.result.result, kFailed);
      EXPECT_STRNE(response.result.error_message, "");
    });
  }));
  EXPECT_TRUE(Eventually(
      [&] { return caller.simulate_.Receive([](const auto& response) { EXPECT_FALSE(response.accepted); }); }));
  run.Interrupt();
}

TEST_F(RosGoals, AreAbortedByTheEndOfTheRun) {
  Program run = RunPaused();
  Caller caller;
  caller.OpenGoal(1);
  StepBy(caller.step_, 1);
  run.Signal(SIGINT);
  EXPECT_EQ(caller.AwaitResult(), GoalStatus::kAborted);
  EXPECT_EQ(run.Wait(), 130) << run.output();
}

TEST_F(RosGoals, StepsAreAnsweredAtTheEndOfTheRun) {
  Program run = RunPaused();
  Caller caller;
  simulation_interfaces_srv_dds__StepSimulation_Request_ million{};
  million.steps = 1'000'000;
  caller.step_.Send(million);
  EXPECT_TRUE(Eventually([&] { return CallRun(session_, control::GetStatus()).tick > 0; }));
  run.Signal(SIGINT);
  EXPECT_TRUE(Eventually([&] {
    return caller.step_.Receive([](const auto& response) {
      EXPECT_EQ(response.result.result, kFailed);
      EXPECT_STREQ(response.result.error_message, "the run is over");
    });
  }));
  EXPECT_EQ(run.Wait(), 130) << run.output();
}

TEST_F(RosGoals, OutliveRosParticipantAndAreAnsweredToANewCall) {
  Program run = RunPaused();
  {
    Caller caller;
    caller.OpenGoal(1);
  }
  kill(ChildOf(run, "/ros-participant "), SIGKILL);
  Caller caller(4712);  // which knows the next one alone
  caller.AskForResult(1);
  Call(control::Play());
  EXPECT_EQ(caller.AwaitResult(), GoalStatus::kSucceeded);
  run.Interrupt();
}

}  // namespace
}  // namespace troupe::test
