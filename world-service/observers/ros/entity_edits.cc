#include "world-service/observers/ros/entity_edits.h"

#include <utility>

#include "world-service/observers/ros/entity_pose.h"
#include "world-service/observers/ros/resource_path.h"

namespace troupe {
namespace {

using ros::RosCaller;

constexpr auto kOk = static_cast<std::uint8_t>(ResultCode::kOk);
constexpr std::uint8_t kInvalidStatePose = 101;  // of SetEntityState
// Of SpawnEntity.
constexpr std::uint8_t kNameNotUnique = 101;
constexpr std::uint8_t kUnsupportedFormat = 103;
constexpr std::uint8_t kNoResource = 104;
constexpr std::uint8_t kInvalidNamespace = 105;
constexpr std::uint8_t kMalformedResource = 106;
constexpr std::uint8_t kInvalidSpawnPose = 109;

bool IsZero(const geometry_msgs_msg_dds__Twist_& twist) {
  return twist.linear.x == 0.0 && twist.linear.y == 0.0 && twist.linear.z == 0.0 && twist.angular.x == 0.0 &&
         twist.angular.y == 0.0 && twist.angular.z == 0.0;
}

std::uint8_t SpawnCode(const ControlReply& reply, const std::string& source) {
  if (reply.done) return kOk;
  if (reply.problem_code == ErrorCode::kNoRoom) return kInvalidSpawnPose;
  if (HasOtherFormat(source, {".world", ".inc", ".json"})) return kUnsupportedFormat;
  if (reply.problem_code == ErrorCode::kMalformed) return kMalformedResource;
  return static_cast<std::uint8_t>(ResultCode::kOperationFailed);
}

}  // namespace

void EntityEdits::Open(const ros::RosNode& node, const std::string& prefix, ros::Distribution distribution) {
  spawn_.Open(node, prefix + "spawn_entity", Bind(&EntityEdits::OnSpawn));
  delete_.Open(node, prefix + "delete_entity", Bind(&EntityEdits::OnDelete));
  if (distribution == ros::Distribution::kRolling) {
    set_rolling_state_.Open(node, prefix + "set_entity_state", Bind(&EntityEdits::OnSetRollingState));
  } else {
    set_state_.Open(node, prefix + "set_entity_state", Bind(&EntityEdits::OnSetState));
  }
}

void EntityEdits::Close() {
  spawn_.Close();
  delete_.Close();
  set_state_.Close();
  set_rolling_state_.Close();
}

void EntityEdits::OnSetState(const RosCaller& caller,
                             const simulation_interfaces_srv_dds__SetEntityState_Request_& request) {
  SetState(caller, request.entity, request.state, true, !IsZero(request.state.twist), set_state_);
}

void EntityEdits::OnSetRollingState(const RosCaller& caller,
                                    const rolling_simulation_interfaces_srv_dds__SetEntityState_Request_& request) {
  const bool moves = request.set_twist && !IsZero(request.state.twist);
  SetState(caller, request.entity, request.state, request.set_pose, moves || request.set_acceleration,
           set_rolling_state_);
}

template <typename Slot>
void EntityEdits::SetState(const RosCaller& caller, const char* entity_name,
                           const simulation_interfaces_msg_dds__EntityState_& state, bool set_pose, bool moves,
                           Slot& slot) {
  const auto answer = [caller, &slot](std::uint8_t code, const std::string& problem) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__SetEntityState_Response_ response{};
    response.result = MakeResult(code, problem, arena);
    slot.Respond(caller, response);
  };
  if (moves) {
    return answer(static_cast<std::uint8_t>(ResultCode::kUnsupported), "only the pose of an entity can be set");
  }
  const Result<Pose> pose = PoseFromRos(state.header.frame_id, state.pose);
  if (set_pose && !pose.ok()) return answer(kInvalidStatePose, pose.error().message);
  const std::string name = dds::Text(entity_name);
  FindEntity(name, [=](EntityEdits& self, const ControlReply&, const EntityReport* entity) {
    if (entity == nullptr) {
      return answer(static_cast<std::uint8_t>(ResultCode::kNotFound), "no entity '" + name + "'");
    }
    if (!set_pose) return answer(kOk, "");
    ControlRequest move;
    move.command = ControlCommand::kSetPose;
    move.name = entity->name;
    move.pose = pose.value();
    self.Ask(move, [answer](EntityEdits&, const ControlReply& reply) {
      answer(reply.done ? kOk : kInvalidStatePose, reply.problem);
    });
  });
}

void EntityEdits::AnswerSpawn(const RosCaller& caller, std::uint8_t code, const std::string& problem,
                              const std::string& name) {
  dds::WireArena arena;
  simulation_interfaces_srv_dds__SpawnEntity_Response_ response{};
  response.result = MakeResult(code, problem, arena);
  response.entity_name = arena.Copy(name);
  spawn_.Respond(caller, response);
}

void EntityEdits::OnSpawn(const RosCaller& caller, const simulation_interfaces_srv_dds__SpawnEntity_Request_& request) {
  ControlRequest spawn;
  spawn.command = ControlCommand::kSpawn;
  spawn.source = ResourcePath(request.uri);
  spawn.name = dds::Text(request.name);
  spawn.rename = request.allow_renaming;
  const std::string name_space = dds::Text(request.entity_namespace);
  if (spawn.source.empty()) {
    const bool has_text = !dds::Text(request.resource_string).empty();
    return AnswerSpawn(caller, has_text ? kUnsupportedFormat : kNoResource,
                       "found no uri, expected a file or one of the spawnables", "");
  }
  if (!name_space.empty() && name_space != spawn.name && name_space != "/" + spawn.name) {
    return AnswerSpawn(caller, kInvalidNamespace, "a robot's namespace is its name, expected no other", "");
  }
  const Result<Pose> pose = PoseFromRos(request.initial_pose.header.frame_id, request.initial_pose.pose);
  if (!pose.ok()) return AnswerSpawn(caller, kInvalidSpawnPose, pose.error().message, "");
  spawn.pose = pose.value();
  FindEntity(spawn.name, [caller, spawn](EntityEdits& self, const ControlReply&, const EntityReport* other) {
    if (other != nullptr && !spawn.rename) {
      return self.AnswerSpawn(caller, kNameNotUnique, "the name '" + spawn.name + "' is in use", "");
    }
    self.Ask(spawn, [caller, source = spawn.source](EntityEdits& edits, const ControlReply& reply) {
      const std::string name = reply.entities.empty() ? "" : edits.context().RosNameOf(reply.entities.front());
      edits.AnswerSpawn(caller, SpawnCode(reply, source), reply.problem, name);
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
