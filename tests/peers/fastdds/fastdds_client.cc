// A client of ROS services on Fast DDS. Prints JSON lines and ends after the last response. Loopback only.
//   fastdds_client DOMAIN step N [/ROBOT=VX]            steps a paused run N times, after a Twist if one is given
//   fastdds_client DOMAIN gripper /ROBOT/GRIPPER GOAL ...   sends goals to the action gripper_cmd, one after another
// GOAL: an opening in m; GOAL!OPENING cancels it as soon as the fingers have opened further than OPENING.
#include <cmath>
#include <cstdlib>

#include "actionsPubSubTypes.h"
#include "geometryPubSubTypes.h"
#include "navigationPubSubTypes.h"
#include "peer.h"
#include "service_client.h"
#include "simulationPubSubTypes.h"

namespace {

void Step(Peer& peer, int steps, const char* drive) {
  namespace srv = simulation_interfaces::srv::dds_;
  DataWriter* commands = nullptr;
  geometry_msgs::msg::dds_::Twist_ twist;
  if (drive != nullptr) {
    const std::string argument = drive;
    commands =
        peer.Write<geometry_msgs::msg::dds_::Twist_PubSubType>(argument.substr(0, argument.find('=')) + "/cmd_vel");
    twist.linear().x(std::strtod(argument.c_str() + argument.find('=') + 1, nullptr));
  }
  Client<srv::StepSimulation_Request_PubSubType, srv::StepSimulation_Response_PubSubType> client(
      peer, "/world/step_simulation");
  client.WaitForService();
  if (commands != nullptr) {
    Until([&] {
      PublicationMatchedStatus status;
      commands->get_publication_matched_status(status);
      return status.current_count > 0;
    });
    // A command written before the robot has discovered this writer is lost, and DDS does not report when discovery is
    // complete; so it is repeated for long enough.
    for (int i = 0; i < 100; ++i) {
      commands->write(&twist);
      usleep(10'000);
    }
  }
  int done = 0;
  for (int i = 0; i < steps; ++i) {
    if (commands != nullptr) {
      // A different one each time, sent long enough before the step.
      twist.angular().z(i % 7 - 3);
      commands->write(&twist);
      commands->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(kSeconds, 0));
    }
    srv::StepSimulation_Request_ request;
    request.steps(1);
    done += client.Call(request).result().result() == 1;
  }
  Print({{"topic", "stepped"}, {"steps", done}, {"repeated", client.repeated()}});
  peer.Close();
}

namespace action = control_msgs::action::dds_;

class Gripper {
 public:
  Gripper(Peer& peer, const std::string& name)
      : send_goal_(peer, name + "/gripper_cmd/_action/send_goal"),
        get_result_(peer, name + "/gripper_cmd/_action/get_result"),
        cancel_(peer, name + "/gripper_cmd/_action/cancel_goal") {
    peer.Read<action::GripperCommand_FeedbackMessage_PubSubType>(
        name + "/gripper_cmd/_action/feedback",
        [this](const action::GripperCommand_FeedbackMessage_& message) {
          const auto& feedback = message.feedback();
          Print({{"topic", "feedback"},
                 {"goal", message.goal_id().uuid()[0]},
                 {"position", feedback.position()},
                 {"effort", feedback.effort()},
                 {"stalled", feedback.stalled()},
                 {"reached", feedback.reached_goal()}});
          opening_ = feedback.position();
        },
        false);
    peer.Read<action_msgs::msg::dds_::GoalStatusArray_PubSubType>(
        name + "/gripper_cmd/_action/status",
        [](const action_msgs::msg::dds_::GoalStatusArray_& message) {
          json line = {{"topic", "status"}, {"goals", json::array()}};
          for (const auto& status : message.status_list()) {
            line["goals"].push_back({status.goal_info().goal_id().uuid()[0], status.status()});
          }
          Print(line);
        },
        true);
    send_goal_.WaitForService();
    get_result_.WaitForService();
    cancel_.WaitForService();
    const std::string robot = name.substr(0, name.rfind('/'));
    AwaitSampleOf<nav_msgs::msg::dds_::Odometry_PubSubType>(peer, robot + "/odom");
  }

  void Do(const std::string& goal) {
    action::GripperCommand_SendGoal_Request_ request;
    request.goal_id().uuid()[0] = ++id_;
    request.goal().command().position(std::strtod(goal.c_str(), nullptr));
    opening_ = 0.0;
    const auto sent = send_goal_.Call(request);
    Print({{"topic", "sent"}, {"goal", id_}, {"accepted", sent.accepted()}, {"stamp", sent.stamp().sec()}});
    if (!sent.accepted()) return;
    action::GripperCommand_GetResult_Request_ ask;
    ask.goal_id(request.goal_id());
    const std::int64_t asked = get_result_.Send(ask);
    if (const std::size_t mark = goal.find('!'); mark != std::string::npos) {
      const double enough = std::strtod(goal.c_str() + mark + 1, nullptr);
      Until([&] { return opening_ > enough; });
      action_msgs::srv::dds_::CancelGoal_Request_ cancel;
      cancel.goal_info().goal_id(request.goal_id());
      const auto canceled = cancel_.Call(cancel);
      Print({{"topic", "canceled"}, {"code", canceled.return_code()}, {"goals", canceled.goals_canceling().size()}});
    }
    const auto ended = get_result_.Await(asked);
    Print({{"topic", "result"},
           {"goal", id_},
           {"status", ended.status()},
           {"position", ended.result().position()},
           {"effort", ended.result().effort()},
           {"stalled", ended.result().stalled()},
           {"reached", ended.result().reached_goal()}});
  }

 private:
  Client<action::GripperCommand_SendGoal_Request_PubSubType, action::GripperCommand_SendGoal_Response_PubSubType>
      send_goal_;
  Client<action::GripperCommand_GetResult_Request_PubSubType, action::GripperCommand_GetResult_Response_PubSubType>
      get_result_;
  Client<action_msgs::srv::dds_::CancelGoal_Request_PubSubType, action_msgs::srv::dds_::CancelGoal_Response_PubSubType>
      cancel_;
  std::atomic<double> opening_ = 0.0;  // m, of the newest feedback
  std::uint8_t id_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  Peer peer(static_cast<std::uint32_t>(std::stoul(argv[1])));
  const std::string what = argv[2];
  try {
    if (what == "step") {
      Step(peer, std::atoi(argv[3]), argc > 4 ? argv[4] : nullptr);
    } else {
      Gripper gripper(peer, argv[3]);
      for (int i = 4; i < argc; ++i) gripper.Do(argv[i]);
      peer.Close();
    }
  } catch (const std::exception& exception) {
    Print({{"topic", "failed"}, {"why", exception.what()}});
    std::_Exit(1);
  }
  Print({{"topic", "done"}});
  return 0;
}
