#include "world-service/observers/ros/entity_edits.h"

#include <utility>

#include "ros/messages/robot_in_ros.h"
#include "world-service/observers/ros/request_values.h"

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

using ros::RosCaller;

constexpr auto kSpawned = static_cast<std::uint8_t>(ResultCode::kOk);
// Of SpawnEntity.
constexpr std::uint8_t kNameNotUnique = 101;
constexpr std::uint8_t kUnsupportedFormat = 103;
constexpr std::uint8_t kNoResource = 104;
constexpr std::uint8_t kInvalidNamespace = 105;
constexpr std::uint8_t kMalformedResource = 106;
constexpr std::uint8_t kInvalidSpawnPose = 109;
// Of SpawnEntities.
constexpr std::uint8_t kEntitiesSpawnFailed = 150;

std::uint8_t SpawnCode(const ControlReply& reply, const ControlRequest& request) {
  if (reply.done) return kSpawned;
  if (reply.problem_code == ErrorCode::kNoRoom) return kInvalidSpawnPose;
  if (HasOtherFormat(request.source, {".world", ".inc", ".json"})) return kUnsupportedFormat;
  if (reply.problem_code == ErrorCode::kMalformed) return kMalformedResource;
  return static_cast<std::uint8_t>(ResultCode::kOperationFailed);
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

struct EntitySpawns::Orders {
  RosCaller caller;
  std::vector<Order> orders;
  std::vector<Spawned> spawned;
};

void EntitySpawns::Open(const ros::RosNode& node, const std::string& prefix) {
  spawn_.Open(node, prefix + "spawn_entity", Bind(&EntitySpawns::OnSpawn));
  spawn_several_.Open(node, prefix + "spawn_entities", Bind(&EntitySpawns::OnSpawnSeveral));
}

void EntitySpawns::Close() {
  spawn_.Close();
  spawn_several_.Close();
}

void EntitySpawns::OnSpawn(const RosCaller& caller,
                           const simulation_interfaces_srv_dds__SpawnEntity_Request_& request) {
  const Order order{dds::Text(request.name),
                    request.allow_renaming,
                    dds::Text(request.uri),
                    dds::Text(request.resource_string),
                    dds::Text(request.entity_namespace),
                    PoseFromRos(request.initial_pose.header.frame_id, request.initial_pose.pose)};
  Spawn(order, [caller](EntitySpawns& self, const Spawned& spawned) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__SpawnEntity_Response_ response{};
    response.result = MakeResult(spawned.code, spawned.problem, arena);
    response.entity_name = arena.Copy(spawned.name);
    self.spawn_.Respond(caller, response);
  });
}

void EntitySpawns::OnSpawnSeveral(const RosCaller& caller,
                                  const simulation_interfaces_srv_dds__SpawnEntities_Request_& request) {
  auto orders = std::make_shared<Orders>();
  orders->caller = caller;
  for (const auto& order : dds::Elements(request.spawn_requests)) {
    orders->orders.push_back({dds::Text(order.name), order.allow_renaming, dds::Text(order.entity_resource.uri),
                              dds::Text(order.entity_resource.resource_string), dds::Text(order.entity_namespace),
                              PoseFromRos(order.initial_pose.header.frame_id, order.initial_pose.pose)});
  }
  SpawnNext(orders);
}

void EntitySpawns::SpawnNext(const std::shared_ptr<Orders>& orders) {
  if (orders->spawned.size() < orders->orders.size()) {
    return Spawn(orders->orders[orders->spawned.size()], [orders](EntitySpawns& self, const Spawned& spawned) {
      orders->spawned.push_back(spawned);
      self.SpawnNext(orders);
    });
  }
  dds::WireArena arena;
  simulation_interfaces_srv_dds__SpawnEntities_Response_ response{};
  std::size_t failed = 0;
  auto* result = arena.Fill(response.results, orders->spawned.size());
  for (const Spawned& spawned : orders->spawned) {
    if (spawned.code != kSpawned) ++failed;
    *result++ = {MakeResult(spawned.code, spawned.problem, arena), arena.Copy(spawned.name)};
  }
  const std::string problem = std::to_string(failed) + " of " + std::to_string(orders->spawned.size()) + " failed";
  response.result = MakeResult(failed == 0 ? kSpawned : kEntitiesSpawnFailed, failed == 0 ? "" : problem, arena);
  spawn_several_.Respond(orders->caller, response);
}

Result<std::string> EntitySpawns::NamespaceOf(const std::string& asked, const std::string& name) const {
  const std::string name_space = asked.empty() || asked.starts_with("/") ? asked : "/" + asked;
  if (name_space.empty() || name_space == "/" + name) return std::string();
  if (!ros::IsNamespace(name_space)) {
    return Error{{},
                 "found the namespace '" + asked +
                     "', expected names of letters, digits and underscores with a "
                     "slash between them"};
  }
  const WorldDescription& world = context().scene()->world();
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (!IsThere(world, RobotId(i))) continue;
    if (ros::FindRobotInRos(world, RobotId(i), 0, {}).node_namespace == name_space) {
      return Error{{}, "the namespace '" + asked + "' is that of '" + world.robots[i].name + "'"};
    }
  }
  return name_space;
}

void EntitySpawns::Spawn(const Order& order, const Answer& answer) {
  if (order.uri.empty() && order.text.empty()) {
    return answer(*this, {kNoResource, "found no uri, expected a file or one of the spawnables", ""});
  }
  if (order.uri.empty() && IsOtherText(order.text)) {
    return answer(*this, {kUnsupportedFormat, "found a text of XML, expected a Stage world or a scenario", ""});
  }
  if (!order.pose.ok()) return answer(*this, {kInvalidSpawnPose, order.pose.error().message, ""});
  Result<std::string> name_space = NamespaceOf(order.name_space, order.name);
  if (!name_space.ok()) return answer(*this, {kInvalidNamespace, name_space.error().message, ""});
  ControlRequest spawn;
  spawn.command = ControlCommand::kSpawn;
  spawn.source = ResourcePath(order.uri.c_str());
  if (order.uri.empty()) spawn.text = order.text;
  spawn.name = order.name;
  spawn.rename = order.rename;
  spawn.ros_namespace = std::move(name_space).value();
  spawn.pose = order.pose.value();
  FindEntity(spawn.name, [spawn, answer](EntitySpawns& self, const ControlReply&, const EntityReport* other) {
    if (other != nullptr && !spawn.rename) {
      return answer(self, {kNameNotUnique, "the name '" + spawn.name + "' is in use", ""});
    }
    self.Ask(spawn, [spawn, answer](EntitySpawns& spawns, const ControlReply& reply) {
      const std::string name = reply.entities.empty() ? "" : spawns.context().RosNameOf(reply.entities.front());
      answer(spawns, {SpawnCode(reply, spawn), reply.problem, name});
    });
  });
}

}  // namespace troupe
