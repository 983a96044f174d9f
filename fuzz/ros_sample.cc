// Feeds any bytes to the receivers of ROS messages and requests: from CDR to a sample, and to the pure function that
// its handler calls, if there is one.
#include <cmath>

#include "fuzz/targets.h"
#include "fuzz/whole_sample.h"
#include "robot-agent/drive/drive.h"
#include "robot-agent/ros/gripper_action.h"
#include "ros/connection/action_server.h"
#include "ros/connection/topic_types.h"
#include "transport/dds/binding/wire.h"
#include "transport/wire/cdr.h"
#include "world-service/observers/ros/request_values.h"

namespace troupe::fuzz {
namespace {

// Calls use(sample) if the bytes are those of a sample.
template <typename Wire, typename Use>
void Read(Bytes bytes, Use use) {
  const auto sample = wire::FromCdr<Wire>(WholeSample<Wire>(bytes));
  if (sample.ok()) {
    use(sample.value().data());
  } else {
    Check(!sample.error().message.empty());
  }
}

// For types whose handlers have no function of their own.
template <typename Wire>
void Read(Bytes bytes) {
  Read<Wire>(bytes, [](const Wire&) {});
}

void UseTwist(const ros::TwistMessage& twist) {
  for (const DriveType type : {DriveType::kDifferential, DriveType::kOmni, DriveType::kCar}) {
    const Twist wanted{twist.linear.x, twist.linear.y, twist.angular.z};
    if (!IsFinite(wanted)) return;
    const Command command = CommandFromTwist(wanted, {.type = type, .wheelbase = 0.5});
    Check(IsFinite(command.twist) && !std::isnan(command.speed) && std::isfinite(command.steering));
  }
}

void UsePose(const char* frame, const ros::PoseMessage& pose) {
  const Result<Pose> result = PoseFromRos(frame, pose);
  Check(result.ok() ? IsFinite(result.value()) : !result.error().message.empty());
}

void UseFilters(const simulation_interfaces_msg_dds__EntityFilters_& filters) {
  const Result<EntityFilter> filter = EntityFilter::Make(filters);
  if (!filter.ok()) return;
  EntityReport robot;
  robot.name = "robot_0";
  robot.kind = EntityKind::kRobot;
  static_cast<void>(filter.value().Matches(robot.name, robot, 0, {"tag"}));
}

void UseGoal(const control_msgs_action_dds__GripperCommand_SendGoal_Request_& request) {
  GripperGoals goals(0.2, 0.1, 100'000'000);
  goals.Accept(ros::ToGoalId(request.goal_id), request.goal.command.position, request.goal.command.max_effort);
  if (const auto order = goals.Begin(1)) Check(!order->opening || (*order->opening >= 0.0 && *order->opening <= 0.2));
}

void UseCancellation(const action_msgs_srv_dds__CancelGoal_Request_& request) {
  GripperGoals goals(0.2, 0.1, 100'000'000);
  goals.Accept({1}, 0.05, 0.0);
  const std::int64_t stamp =
      std::int64_t{request.goal_info.stamp.sec} * 1'000'000'000 + request.goal_info.stamp.nanosec;
  static_cast<void>(goals.Cancel(ros::ToGoalId(request.goal_info.goal_id), stamp));
}

using Receiver = void (*)(Bytes);

constexpr Receiver kReceivers[] = {
    [](Bytes bytes) { Read<ros::TwistMessage>(bytes, UseTwist); },
    [](Bytes bytes) { Read<ros::TwistStamped>(bytes, [](const auto& stamped) { UseTwist(stamped.twist); }); },
    [](Bytes bytes) { Read<control_msgs_action_dds__GripperCommand_SendGoal_Request_>(bytes, UseGoal); },
    [](Bytes bytes) { Read<action_msgs_srv_dds__CancelGoal_Request_>(bytes, UseCancellation); },
    [](Bytes bytes) {
      Read<simulation_interfaces_srv_dds__GetEntities_Request_>(bytes, [](const auto& r) { UseFilters(r.filters); });
    },
    [](Bytes bytes) {
      Read<simulation_interfaces_srv_dds__SetEntityState_Request_>(
          bytes, [](const auto& r) { UsePose(r.state.header.frame_id, r.state.pose); });
    },
    [](Bytes bytes) {
      Read<rolling_simulation_interfaces_srv_dds__SetEntityState_Request_>(
          bytes, [](const auto& r) { UsePose(r.state.header.frame_id, r.state.pose); });
    },
    [](Bytes bytes) {
      Read<simulation_interfaces_srv_dds__SpawnEntity_Request_>(bytes, [](const auto& r) {
        UsePose(r.initial_pose.header.frame_id, r.initial_pose.pose);
        static_cast<void>(ResourcePath(r.uri));
      });
    },
    [](Bytes bytes) {
      Read<simulation_interfaces_srv_dds__LoadWorld_Request_>(bytes, [](const auto& r) { ResourcePath(r.uri); });
    },
    Read<ros::Float64>,
    Read<control_msgs_action_dds__GripperCommand_GetResult_Request_>,
    Read<rcl_interfaces_srv_dds__DescribeParameters_Request_>,
    Read<rcl_interfaces_srv_dds__GetParameters_Request_>,
    Read<rcl_interfaces_srv_dds__ListParameters_Request_>,
    Read<rcl_interfaces_srv_dds__SetParameters_Request_>,
    Read<rmw_dds_common_msg_dds__ParticipantEntitiesInfo_>,
    Read<simulation_interfaces_action_dds__SimulateSteps_SendGoal_Request_>,
    Read<simulation_interfaces_srv_dds__DeleteEntity_Request_>,
    Read<simulation_interfaces_srv_dds__GetEntityState_Request_>,
    Read<simulation_interfaces_srv_dds__ResetSimulation_Request_>,
    Read<simulation_interfaces_srv_dds__SetSimulationState_Request_>,
    Read<simulation_interfaces_srv_dds__StepSimulation_Request_>,
};

}  // namespace

void RosSample(Bytes bytes) {
  if (bytes.empty()) return;
  kReceivers[std::to_integer<std::size_t>(bytes.front()) % std::size(kReceivers)](bytes.subspan(1));
}

}  // namespace troupe::fuzz
