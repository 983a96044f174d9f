#include "world-service/observers/ros/entity_edits.h"

#include <utility>

#include "world-service/observers/ros/entity_pose.h"

namespace troupe {
namespace {

using ros::RosCaller;

constexpr auto kOk = static_cast<std::uint8_t>(ResultCode::kOk);
constexpr std::uint8_t kInvalidStatePose = 101;  // of SetEntityState
constexpr auto kFailed = static_cast<std::uint8_t>(ResultCode::kOperationFailed);

bool IsZero(const geometry_msgs_msg_dds__Twist_& twist) {
  return twist.linear.x == 0.0 && twist.linear.y == 0.0 && twist.linear.z == 0.0 && twist.angular.x == 0.0 &&
         twist.angular.y == 0.0 && twist.angular.z == 0.0;
}

}  // namespace

void EntityEdits::Open(const ros::RosNode& node, const std::string& prefix, ros::Distribution distribution) {
  delete_.Open(node, prefix + "delete_entity", Bind(&EntityEdits::OnDelete));
  if (distribution == ros::Distribution::kRolling) {
    set_rolling_state_.Open(node, prefix + "set_entity_state", Bind(&EntityEdits::OnSetRollingState));
  } else {
    set_state_.Open(node, prefix + "set_entity_state", Bind(&EntityEdits::OnSetState));
  }
}

void EntityEdits::Close() {
  delete_.Close();
  set_state_.Close();
  set_rolling_state_.Close();
}

void EntityEdits::OnSetState(const RosCaller& caller,
                             const simulation_interfaces_srv_dds__SetEntityState_Request_& request) {
  SetState(caller, request.entity, request.state, {true, !IsZero(request.state.twist), false}, set_state_);
}

void EntityEdits::OnSetRollingState(const RosCaller& caller,
                                    const rolling_simulation_interfaces_srv_dds__SetEntityState_Request_& request) {
  SetState(caller, request.entity, request.state, {request.set_pose, request.set_twist, request.set_acceleration},
           set_rolling_state_);
}

template <typename Slot>
void EntityEdits::SetState(const RosCaller& caller, const char* entity_name,
                           const simulation_interfaces_msg_dds__EntityState_& state, const Parts& parts, Slot& slot) {
  const auto answer = [caller, &slot](std::uint8_t code, const std::string& problem) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__SetEntityState_Response_ response{};
    response.result = MakeResult(code, problem, arena);
    slot.Respond(caller, response);
  };
  if (parts.acceleration) {
    return answer(static_cast<std::uint8_t>(ResultCode::kUnsupported), "the acceleration of an entity cannot be set");
  }
  const Result<Pose> pose = PoseFromRos(state.header.frame_id, state.pose);
  if (parts.pose && !pose.ok()) return answer(kInvalidStatePose, pose.error().message);
  const Result<Twist> twist = TwistFromRos(state.twist);
  if (parts.twist && !twist.ok()) return answer(kFailed, twist.error().message);
  const std::string name = dds::Text(entity_name);
  FindEntity(name, [=](EntityEdits& self, const ControlReply&, const EntityReport* entity) {
    if (entity == nullptr) {
      return answer(static_cast<std::uint8_t>(ResultCode::kNotFound), "no entity '" + name + "'");
    }
    if (parts.twist && entity->kind != EntityKind::kRobot && !twist.value().IsZero()) {
      return answer(kFailed, "'" + name + "' is no robot: it has no drive");
    }
    ControlRequest turn;
    turn.command = ControlCommand::kSetTwist;
    turn.name = entity->name;
    if (parts.twist) turn.twist = twist.value();
    const bool turns = parts.twist && entity->kind == EntityKind::kRobot;
    const auto set_twist = [turn, answer](EntityEdits& edits) {
      edits.Ask(turn, [answer](EntityEdits&, const ControlReply& reply) {
        answer(reply.done ? kOk : kFailed, reply.problem);
      });
    };
    if (!parts.pose) return turns ? set_twist(self) : answer(kOk, "");
    ControlRequest move;
    move.command = ControlCommand::kSetPose;
    move.name = entity->name;
    move.pose = pose.value();
    self.Ask(move, [answer, turns, set_twist](EntityEdits& edits, const ControlReply& reply) {
      if (reply.done && turns) return set_twist(edits);
      answer(reply.done ? kOk : kInvalidStatePose, reply.problem);
    });
  });
}

void EntityEdits::AnswerDelete(const RosCaller& caller, ResultCode code, const std::string& problem) {
  dds::WireArena arena;
  simulation_interfaces_srv_dds__DeleteEntity_Response_ response{};
  response.result = MakeResult(code, problem, arena);
  delete_.Respond(caller, response);
}

void EntityEdits::OnDelete(const RosCaller& caller,
                           const simulation_interfaces_srv_dds__DeleteEntity_Request_& request) {
  const std::string name = dds::Text(request.entity);
  FindEntity(name, [caller, name](EntityEdits& self, const ControlReply&, const EntityReport* entity) {
    if (entity == nullptr) return self.AnswerDelete(caller, ResultCode::kNotFound, "no entity '" + name + "'");
    ControlRequest removal;
    removal.command = ControlCommand::kDelete;
    removal.name = entity->name;
    self.Ask(removal, [caller](EntityEdits& edits, const ControlReply& reply) {
      edits.AnswerDelete(caller, CodeOf(reply), reply.problem);
    });
  });
}

}  // namespace troupe
