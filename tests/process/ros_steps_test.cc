// The action simulation_interfaces/SimulateSteps of whole runs, used as by a ROS program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/action_goals.h"
#include "tests/process/programs.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"
#include "troupe/ids.h"

namespace troupe::test {
namespace {

using ros::CancelAnswer;
using ros::GoalStatus;
using testing::HasSubstr;

constexpr std::uint8_t kPlaying = 1;
constexpr std::uint8_t kPaused = 2;

struct Ended {
  GoalStatus status = GoalStatus::kUnknown;
  std::uint8_t result = 0;
  std::string message;
};

class RosStepsTest : public testing::Test {
 protected:
  bool Send(std::uint8_t id, std::uint64_t steps) {
    simulation_interfaces_action_dds__SimulateSteps_SendGoal_Request_ request{};
    request.goal_id.uuid[0] = id;
    request.goal.steps = steps;
    bool accepted = false;
    send_.Call(request, [&](const auto& response) { accepted = response.accepted; });
    return accepted;
  }
  void AskForResult(std::uint8_t id) {
    simulation_interfaces_action_dds__SimulateSteps_GetResult_Request_ request{};
    request.goal_id.uuid[0] = id;
    result_.Send(request);
  }
  Ended AwaitResult() {
    Ended ended;
    EXPECT_TRUE(Eventually([&] {
      return result_.Receive([&](const auto& response) {
        ended = {GoalStatus(response.status), response.result.result.result,
                 dds::Text(response.result.result.error_message)};
      });
    }));
    return ended;
  }
  Ended ResultOf(std::uint8_t id) {
    AskForResult(id);
    return AwaitResult();
  }
  CancelAnswer Cancel(std::uint8_t id) {
    action_msgs_srv_dds__CancelGoal_Request_ request{};
    request.goal_info.goal_id.uuid[0] = id;
    CancelAnswer answer = CancelAnswer::kNone;
    cancel_.Call(request, [&](const auto& response) { answer = CancelAnswer(response.return_code); });
    return answer;
  }
  std::uint8_t SetState(std::uint8_t state) {
    simulation_interfaces_srv_dds__SetSimulationState_Request_ request{};
    request.state.state = state;
    std::uint8_t result = 0;
    set_state_.Call(request, [&](const auto& response) { result = response.result.result; });
    return result;
  }
  std::uint8_t State() {
    std::uint8_t state = 0;
    get_state_.Call({}, [&](const auto& response) { state = response.state.state; });
    return state;
  }
  std::uint8_t StepResult() {
    simulation_interfaces_srv_dds__StepSimulation_Request_ one{};
    one.steps = 1;
    std::uint8_t result = 0;
    step_.Call(one, [&](const auto& response) { result = response.result.result; });
    return result;
  }
  std::uint8_t Reset() {
    std::uint8_t result = 0;
    reset_.Call({}, [&](const auto& response) { result = response.result.result; });
    return result;
  }
  void Step() { EXPECT_EQ(StepResult(), kOk); }
  std::int64_t Now() {
    simulation_interfaces_srv_dds__GetEntityState_Request_ request{};
    request.entity = const_cast<char*>("r0");
    std::int64_t tick = 0;
    entity_.Call(request, [&](const auto& response) { tick = TickOf(response.state.header.stamp); });
    return tick;
  }
  // Completed and remaining steps of goal `id`, from the feedback so far.
  const std::vector<std::pair<std::uint64_t, std::uint64_t>>& Feedback(std::uint8_t id) {
    feedback_.Drain([&](const auto& message) {
      feedback_of_goals_[message.goal_id.uuid[0]].emplace_back(message.feedback.completed_steps,
                                                               message.feedback.remaining_steps);
    });
    return feedback_of_goals_[id];
  }
  // The statuses by the id of the goal.
  std::map<int, GoalStatus> Statuses() {
    status_.Drain([&](const auto& message) {
      statuses_.clear();
      for (const auto& goal : dds::Elements(message.status_list)) {
        statuses_[goal.goal_info.goal_id.uuid[0]] = GoalStatus(goal.status);
      }
    });
    return statuses_;
  }

  Program RunPenPaused() {
    const ros::RosNetwork options = TestRosNetwork();
    return Troupe({"run", WorldPath("pen.world"), "--domain", std::to_string(TestDomain()), "--headless", "--paused",
                   "--speed", "10", "--ros", "--ros-interface", "lo", "--ros-domain", std::to_string(options.domain)});
  }

  ros::RosParticipant participant_{TestRosNetwork()};
  ros::RosNode node_ = ros::MakeNode(participant_, "/", "tester");
  ros::RosReader<simulation_interfaces_action_dds__SimulateSteps_FeedbackMessage_> feedback_{
      node_, "/world/simulate_steps/_action/feedback", ros::Stream(1000)};
  ros::RosReader<action_msgs_msg_dds__GoalStatusArray_> status_{node_, "/world/simulate_steps/_action/status",
                                                                ros::Latched()};
  ros::RosReader<ros::LaserScan> scans_{node_, "/r0/scan", ros::Stream(1000)};

 private:
  template <typename Request, typename Response>
  using Service = Client<Request, Response>;
  Service<simulation_interfaces_action_dds__SimulateSteps_SendGoal_Request_,
          simulation_interfaces_action_dds__SimulateSteps_SendGoal_Response_>
      send_{participant_, "/world/simulate_steps/_action/send_goal"};
  Service<simulation_interfaces_action_dds__SimulateSteps_GetResult_Request_,
          simulation_interfaces_action_dds__SimulateSteps_GetResult_Response_>
      result_{participant_, "/world/simulate_steps/_action/get_result"};
  Service<action_msgs_srv_dds__CancelGoal_Request_, action_msgs_srv_dds__CancelGoal_Response_> cancel_{
      participant_, "/world/simulate_steps/_action/cancel_goal"};
  Service<simulation_interfaces_srv_dds__SetSimulationState_Request_,
          simulation_interfaces_srv_dds__SetSimulationState_Response_>
      set_state_{participant_, "/world/set_simulation_state"};
  Service<simulation_interfaces_srv_dds__GetSimulationState_Request_,
          simulation_interfaces_srv_dds__GetSimulationState_Response_>
      get_state_{participant_, "/world/get_simulation_state"};
  Service<simulation_interfaces_srv_dds__StepSimulation_Request_,
          simulation_interfaces_srv_dds__StepSimulation_Response_>
      step_{participant_, "/world/step_simulation"};
  Service<simulation_interfaces_srv_dds__ResetSimulation_Request_,
          simulation_interfaces_srv_dds__ResetSimulation_Response_>
      reset_{participant_, "/world/reset_simulation"};
  Service<simulation_interfaces_srv_dds__GetEntityState_Request_,
          simulation_interfaces_srv_dds__GetEntityState_Response_>
      entity_{participant_, "/world/get_entity_state"};
  std::map<int, std::vector<std::pair<std::uint64_t, std::uint64_t>>> feedback_of_goals_;  // by goal
  std::map<int, GoalStatus> statuses_;
};

TEST_F(RosStepsTest, RefusesWhatItsStateDoesNotAllow) {
  Program run = RunPenPaused();
  EXPECT_EQ(StepResult(), kOk);  // once all agents have joined
  EXPECT_EQ(SetState(kPaused), 101) << "already";
  EXPECT_EQ(SetState(0), kOk) << "stopped";
  EXPECT_EQ(SetState(kPaused), 103) << "from stopped";
  EXPECT_EQ(StepResult(), kFailed) << "in a stopped run";
  EXPECT_TRUE(Send(1, 3));
  const Ended in_stopped = ResultOf(1);
  EXPECT_EQ(in_stopped.status, GoalStatus::kAborted);
  EXPECT_EQ(in_stopped.result, kFailed);
  EXPECT_THAT(in_stopped.message, HasSubstr("the run is stopped"));
  EXPECT_EQ(State(), 0) << "it stays stopped";
  EXPECT_EQ(SetState(1), kOk) << "playing";
  EXPECT_EQ(StepResult(), kFailed) << "in a playing run";
  EXPECT_EQ(SetState(kPaused), kOk);
  EXPECT_EQ(StepResult(), kOk);
  run.Interrupt();
}

TEST_F(RosStepsTest, MakesStepsWithFeedbackAfterEachAndTheSensorDataOfTheLast) {
  Program run = RunPenPaused();
  // Until discovery is complete.
  std::int64_t newest = 0;
  const auto see = [&] {
    scans_.Drain([&](const ros::LaserScan& scan) { newest = TickOf(scan.header.stamp); });
    return newest;
  };
  EXPECT_TRUE(Eventually([&] {
    Step();
    return see() > 0;
  }));
  const std::int64_t before = Now();

  ASSERT_TRUE(Send(1, 20));
  const Ended ended = ResultOf(1);
  EXPECT_EQ(ended.status, GoalStatus::kSucceeded);
  EXPECT_EQ(ended.result, kOk);
  EXPECT_EQ(ended.message, "");
  EXPECT_TRUE(Eventually([&] { return !Feedback(1).empty() && Feedback(1).back().second == 0; }));
  ASSERT_EQ(Feedback(1).size(), 20u);
  for (std::uint64_t step = 1; step <= 20; ++step) {
    EXPECT_EQ(Feedback(1)[step - 1], std::make_pair(step, 20 - step));
  }
  // Written before the result, but perhaps still on the network.
  EXPECT_TRUE(Eventually([&] { return see() == before + 20; }));
  EXPECT_EQ(State(), kPaused);
  EXPECT_EQ(Now(), before + 20);
  EXPECT_TRUE(Eventually([&] { return Statuses() == std::map<int, GoalStatus>{{1, GoalStatus::kSucceeded}}; }));
  EXPECT_EQ(ResultOf(9).status, GoalStatus::kUnknown);
  EXPECT_EQ(Cancel(9), CancelAnswer::kUnknownGoal);
  EXPECT_EQ(Cancel(1), CancelAnswer::kGoalHasEnded);
  run.Interrupt();
}

TEST_F(RosStepsTest, StopsWhenCancelledOrPausedAndAcceptsOneGoalAtATime) {
  Program run = RunPenPaused();
  ASSERT_TRUE(Send(1, 1'000'000));
  AskForResult(1);
  EXPECT_TRUE(Eventually([&] { return !Feedback(1).empty(); }));
  EXPECT_FALSE(Send(2, 1)) << "during another goal";
  EXPECT_EQ(StepResult(), kFailed) << "at once, not after the million steps";
  EXPECT_EQ(Reset(), kFailed);
  EXPECT_EQ(Cancel(1), CancelAnswer::kNone);
  const Ended canceled = AwaitResult();
  EXPECT_EQ(canceled.status, GoalStatus::kCanceled);
  EXPECT_EQ(canceled.result, kFailed);
  EXPECT_EQ(State(), kPaused);
  EXPECT_EQ("paused after " + std::to_string(Now()) + " of 1000000 ticks", canceled.message);

  ASSERT_TRUE(Send(3, 1'000'000));
  AskForResult(3);
  EXPECT_TRUE(Eventually([&] { return !Feedback(3).empty(); }));
  EXPECT_EQ(SetState(kPaused), kOk);
  const Ended paused = AwaitResult();
  EXPECT_EQ(paused.status, GoalStatus::kAborted);
  EXPECT_EQ(paused.result, kFailed);
  EXPECT_THAT(paused.message, HasSubstr("paused after"));

  ASSERT_TRUE(Send(4, 0));
  const Ended none = ResultOf(4);
  EXPECT_EQ(none.status, GoalStatus::kAborted);
  EXPECT_EQ(none.result, kFailed);
  EXPECT_EQ(none.message, "ticks: found 0, expected at least 1");

  EXPECT_EQ(SetState(kPlaying), kOk);
  ASSERT_TRUE(Send(5, 3));
  const Ended playing = ResultOf(5);
  EXPECT_EQ(playing.status, GoalStatus::kAborted);
  EXPECT_EQ(playing.result, kFailed);
  EXPECT_EQ(playing.message, "the run is playing; only a paused one can step");
  EXPECT_EQ(State(), kPlaying);

  EXPECT_EQ(SetState(kPaused), kOk);
  ASSERT_TRUE(Send(6, 1'000'000));
  AskForResult(6);
  run.Signal(SIGINT);
  const Ended over = AwaitResult();
  EXPECT_EQ(over.status, GoalStatus::kAborted);
  EXPECT_EQ(over.message, "the run is over");
  EXPECT_EQ(run.Wait(), 130) << run.output();
}

TEST_F(RosStepsTest, AGoalIsAbortedWhenTheServiceDies) {
  Program run = RunPenPaused();
  Step();
  ASSERT_TRUE(Send(1, 1'000'000));
  AskForResult(1);
  EXPECT_TRUE(Eventually([&] { return !Feedback(1).empty(); }));
  for (const pid_t service : ChildrenWith(run, "world-service")) ASSERT_EQ(kill(service, SIGKILL), 0);
  const Ended ended = AwaitResult();
  EXPECT_EQ(ended.status, GoalStatus::kAborted);
  EXPECT_EQ(ended.result, kFailed);
  EXPECT_THAT(ended.message, HasSubstr("world service that has died"));
  EXPECT_TRUE(Eventually([&] { return State() == kPlaying; })) << "its steps go on";
  run.Interrupt();
}

// The topics of a run in a pause, for nodes that start then; and simulated time between ticks.

std::int64_t Nanoseconds(const ros::Time& time) {
  return time.sec * std::int64_t{1'000'000'000} + time.nanosec;
}

// The stamp of the first message on a topic, in ticks.
template <typename T, typename StampOf>
void ExpectStamp(const ros::RosNode& node, const std::string& topic, Tick tick, const StampOf& stamp_of) {
  ros::RosReader<T> reader(node, topic, ros::Stream(1));
  std::optional<std::int64_t> stamp;
  EXPECT_TRUE(Eventually([&] {
    reader.Drain([&](const T& message) { stamp = Nanoseconds(stamp_of(message)); });
    return stamp.has_value();
  })) << topic;
  EXPECT_EQ(stamp.value_or(-1), static_cast<std::int64_t>(tick) * kIntervalNs) << topic;
}

TEST(RosClock, ANodeThatStartsInAPauseLearnsTheTimeAndSeesTheRobots) {
  Program run = RunPen(RosArguments({"--paused", "--speed", "1"}));
  {
    ros::RosParticipant stepper(TestRosNetwork());
    TROUPE_SIMULATION_CLIENT(StepSimulation) step(stepper, "/world/step_simulation");
    StepBy(step, 7);
  }
  ros::RosParticipant late(TestRosNetwork());
  const ros::RosNode node = ros::MakeNode(late, "/", "late");
  ExpectStamp<ros::Clock>(node, "/clock", 7, [](const auto& message) { return message.clock; });
  for (const char* robot : {"/r0", "/r3"}) {
    ExpectStamp<ros::OdometryMessage>(node, std::string(robot) + "/odom", 7,
                                      [](const auto& message) { return message.header.stamp; });
    ExpectStamp<ros::LaserScan>(node, std::string(robot) + "/scan", 7,
                                [](const auto& message) { return message.header.stamp; });
  }
  ros::RosReader<ros::TfMessage> transforms(node, "/tf", ros::Stream(100));
  std::set<std::string> frames;
  EXPECT_TRUE(Eventually([&] {
    transforms.Drain([&](const ros::TfMessage& message) {
      for (const auto& transform : dds::Elements(message.transforms)) frames.insert(transform.child_frame_id);
    });
    return frames.size() == 4;
  })) << testing::PrintToString(frames);
  run.Interrupt();
}

TEST(RosClock, AdvancesBetweenTicksIfAskedWithoutChangingTheRun) {
  TemporaryFolder folder;
  ros::RosParticipant participant(TestRosNetwork());
  ros::RosReader<ros::Clock> reader(ros::MakeNode(participant, "/", "reader"), "/clock", ros::Stream(10'000));
  const std::string session = TestSession("clock");
  Program run = RunPen(RosArguments({"--speed", "1", "--ros-clock-rate", "100", "--ticks", "30", "--paused",
                                     "--session", session, "--hash-log", folder.Path("hashes")}));
  std::vector<std::int64_t> times;
  const auto drain = [&] {
    reader.Drain([&](const ros::Clock& clock) { times.push_back(Nanoseconds(clock.clock)); });
    return !times.empty();
  };
  EXPECT_TRUE(Eventually(drain)) << "in the pause: so the reader is discovered";
  OutputOf(Ctl(session, {"play"}));
  ASSERT_EQ(run.Wait(), 0) << run.output();
  // The last sample may still be on its way.
  EXPECT_TRUE(Eventually([&] { return drain() && times.back() == 30 * kIntervalNs; })) << times.back();
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  // A hundred in a second, on a machine that gives the thread a processor as often.
  const auto is_between = [](std::int64_t ns) { return ns % kIntervalNs != 0; };
  EXPECT_GT(std::count_if(times.begin(), times.end(), is_between), 30) << "of " << times.size();

  TemporaryFolder without;
  OutputOf(RunPen({"--no-ros", "--ticks", "30", "--hash-log", without.Path("hashes")}));
  EXPECT_EQ(folder.Read("hashes"), without.Read("hashes"));
}

}  // namespace
}  // namespace troupe::test
