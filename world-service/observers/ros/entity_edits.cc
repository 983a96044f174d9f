// The services that change entities: those that move and delete them, and those that spawn them, one or several.
#include <algorithm>
#include <cctype>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ros/messages/names.h"
#include "world-service/observers/ros/request_values.h"
#include "world-service/observers/ros/simulation_context.h"

namespace troupe {
namespace {

TROUPE_SIMULATION_SERVICE(DeleteEntity);
TROUPE_SIMULATION_SERVICE(SetEntityState);
TROUPE_SIMULATION_SERVICE(SpawnEntity);
TROUPE_SIMULATION_SERVICE(SpawnEntities);
using NewSetEntityStateRequest = rolling_simulation_interfaces_srv_dds__SetEntityState_Request_;  // of 2.x

constexpr auto kOk = static_cast<std::uint8_t>(ResultCode::kOk);
constexpr auto kFailed = static_cast<std::uint8_t>(ResultCode::kOperationFailed);
constexpr std::uint8_t kInvalidStatePose = 101;  // of SetEntityState
// Results of SpawnEntity.
constexpr std::uint8_t kNameNotUnique = 101;
constexpr std::uint8_t kInvalidName = 102;
constexpr std::uint8_t kUnsupportedFormat = 103;
constexpr std::uint8_t kNoResource = 104;
constexpr std::uint8_t kInvalidNamespace = 105;
constexpr std::uint8_t kMalformedResource = 106;
constexpr std::uint8_t kInvalidSpawnPose = 109;
// Results of SpawnEntities.
constexpr std::uint8_t kEntitiesSpawnFailed = 150;

bool IsZero(const geometry_msgs_msg_dds__Twist_& twist) {
  return twist.linear.x == 0.0 && twist.linear.y == 0.0 && twist.linear.z == 0.0 && twist.angular.x == 0.0 &&
         twist.angular.y == 0.0 && twist.angular.z == 0.0;
}

// The parts of a state that a request sets.
struct Parts {
  bool pose = false;
  bool twist = false;
  bool acceleration = false;
};
Parts PartsOf(const SetEntityStateRequest& request) {
  return {true, !IsZero(request.state.twist), false};
}
Parts PartsOf(const NewSetEntityStateRequest& request) {
  return {request.set_pose, request.set_twist, request.set_acceleration};
}

template <typename Request>
void OnSetEntityState(SimulationContext& context, const Call<Request, SetEntityStateResponse>& call,
                      const Request& request) {
  const Parts parts = PartsOf(request);
  if (parts.acceleration) {
    return call.Answer(ResultCode::kUnsupported, "the acceleration of an entity cannot be set");
  }
  const Result<Pose> pose = PoseFromRos(request.state.header.frame_id, request.state.pose);
  if (parts.pose && !pose.ok()) return call.Answer(kInvalidStatePose, pose.error().message);
  const Result<Twist> twist = TwistFromRos(request.state.twist);
  if (parts.twist && !twist.ok()) return call.Answer(kFailed, twist.error().message);
  const std::string name = dds::Text(request.entity);
  context.FindEntity(name, [=](SimulationContext& self, const ControlReply&, const EntityReport* entity) {
    if (entity == nullptr) return call.Answer(ResultCode::kNotFound, "no entity '" + Shown(name) + "'");
    if (parts.twist && entity->kind != EntityKind::kRobot && !twist.value().IsZero()) {
      return call.Answer(kFailed, "'" + name + "' is no robot: it has no drive");
    }
    const control::SetTwist turn{entity->name, parts.twist ? twist.value() : Twist{}};
    const bool turns = parts.twist && entity->kind == EntityKind::kRobot;
    const auto set_twist = [turn, call](SimulationContext& of_pose) {
      of_pose.Ask(turn, [call](SimulationContext&, const ControlReply& reply) { call.Answer(reply); });
    };
    if (!parts.pose) return turns ? set_twist(self) : call.Answer(kOk, "");
    self.Ask(control::SetPose{entity->name, pose.value()},
             [call, turns, set_twist](SimulationContext& of_pose, const ControlReply& reply) {
               if (reply.done && turns) return set_twist(of_pose);
               call.Answer(reply.done ? kOk : kInvalidStatePose, reply.problem);
             });
  });
}

void OnDeleteEntity(SimulationContext& context, const DeleteEntityCall& call, const DeleteEntityRequest& request) {
  const std::string name = dds::Text(request.entity);
  context.FindEntity(name, [call, name](SimulationContext& self, const ControlReply&, const EntityReport* entity) {
    if (entity == nullptr) return call.Answer(ResultCode::kNotFound, "no entity '" + Shown(name) + "'");
    self.Ask(control::Delete{entity->name},
             [call](SimulationContext&, const ControlReply& reply) { call.Answer(reply); });
  });
}

// A name that tools of ROS and command lines can say: letters, digits and "_.:-", the first one a letter, a digit or
// "_".
bool IsEntityName(const std::string& name) {
  const auto is_letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  const auto is_allowed = [&](char c) { return is_letter(c) || c == '.' || c == ':' || c == '-'; };
  return !name.empty() && name.size() <= kMaxRequestedName && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(), is_allowed);
}

struct SpawnOrder {
  std::string name;
  bool rename = false;
  std::string uri;
  std::string text;  // in place of a file
  std::string name_space;
  Result<Pose> pose = Pose{};
};
struct Spawned {
  std::uint8_t code = 0;
  std::string problem;
  std::string name;
};
using OnSpawned = std::function<void(SimulationContext& context, const Spawned& spawned)>;

// The namespace of a robot called `name`; "" for its name. The error is one that ROS does not allow, or in use.
Result<std::string> NamespaceOf(const WorldDescription& world, const std::string& asked, const std::string& name) {
  const std::string name_space = asked.empty() || asked.starts_with("/") ? asked : "/" + asked;
  if (name_space.empty() || name_space == "/" + name) return std::string();
  if (!ros::IsNamespace(name_space)) {
    return Error{{},
                 "found the namespace '" + Shown(asked) +
                     "', expected names of letters, digits and underscores with a "
                     "slash between them"};
  }
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (!RobotExists(world, RobotId(i))) continue;
    if (ros::FindRobotInRos(world, RobotId(i), 0, {}).node_namespace == name_space) {
      return Error{{}, "the namespace '" + Shown(asked) + "' is that of '" + world.robots[i].name + "'"};
    }
  }
  return name_space;
}

std::uint8_t SpawnCode(const ControlReply& reply, const control::Spawn& request) {
  if (reply.done) return kOk;
  if (reply.problem_code == ErrorCode::kNoRoom) return kInvalidSpawnPose;
  if (HasOtherFormat(request.source, {".world", ".inc", ".json"})) return kUnsupportedFormat;
  if (reply.problem_code == ErrorCode::kMalformed) return kMalformedResource;
  return kFailed;
}

void Spawn(SimulationContext& context, const SpawnOrder& order, const OnSpawned& answer) {
  const auto refuse = [&](std::uint8_t code, const std::string& problem) { answer(context, {code, problem, ""}); };
  if (order.name.empty() && !order.rename)
    return refuse(kInvalidName, "found no name, expected one, or allow_renaming");
  if (!order.name.empty() && !IsEntityName(order.name)) {
    return refuse(kInvalidName, "found the name '" + Shown(order.name) + "', expected at most " +
                                    std::to_string(kMaxRequestedName) +
                                    " letters, digits, '_', '.', ':' and '-', beginning with a letter, a digit or '_'");
  }
  if (order.uri.empty() && order.text.empty()) {
    return refuse(kNoResource, "found no uri, expected a file or one of the spawnables");
  }
  if (order.uri.empty() && IsOtherText(order.text)) {
    return refuse(kUnsupportedFormat, "found a text of XML, expected a Stage world or a scenario");
  }
  if (!order.pose.ok()) return refuse(kInvalidSpawnPose, order.pose.error().message);
  Result<std::string> name_space = NamespaceOf(context.scene()->world(), order.name_space, order.name);
  if (!name_space.ok()) return refuse(kInvalidNamespace, name_space.error().message);
  control::Spawn spawn;
  spawn.source = ResourcePath(order.uri.c_str());
  if (order.uri.empty()) spawn.text = order.text;
  spawn.name = order.name;
  spawn.rename = order.rename;
  spawn.ros_namespace = std::move(name_space).value();
  spawn.pose = order.pose.value();
  context.FindEntity(
      spawn.name, [spawn, answer](SimulationContext& self, const ControlReply&, const EntityReport* other) {
        if (other != nullptr && !spawn.rename) {
          return answer(self, {kNameNotUnique, "the name '" + spawn.name + "' is in use", ""});
        }
        self.Ask(spawn, [spawn, answer](SimulationContext& of_spawn, const ControlReply& reply) {
          const std::string name = reply.entities.empty() ? "" : of_spawn.RosNameOf(reply.entities.front());
          answer(of_spawn, {SpawnCode(reply, spawn), reply.problem, name});
        });
      });
}

void OnSpawnEntity(SimulationContext& context, const SpawnEntityCall& call, const SpawnEntityRequest& request) {
  const SpawnOrder order{dds::Text(request.name),
                         request.allow_renaming,
                         dds::Text(request.uri),
                         dds::Text(request.resource_string),
                         dds::Text(request.entity_namespace),
                         PoseFromRos(request.initial_pose.header.frame_id, request.initial_pose.pose)};
  Spawn(context, order, [call](SimulationContext&, const Spawned& spawned) {
    dds::WireArena arena;
    SpawnEntityResponse response{};
    response.result = MakeResult(spawned.code, spawned.problem, arena);
    response.entity_name = arena.Copy(spawned.name);
    call.Respond(response);
  });
}

// Several orders, one after another.
struct SpawnOrders {
  SpawnEntitiesCall call;
  std::vector<SpawnOrder> orders = {};
  std::vector<Spawned> spawned = {};
};

void SpawnNext(SimulationContext& context, const std::shared_ptr<SpawnOrders>& orders) {
  if (orders->spawned.size() < orders->orders.size()) {
    return Spawn(context, orders->orders[orders->spawned.size()],
                 [orders](SimulationContext& self, const Spawned& spawned) {
                   orders->spawned.push_back(spawned);
                   SpawnNext(self, orders);
                 });
  }
  dds::WireArena arena;
  SpawnEntitiesResponse response{};
  std::size_t failed = 0;
  auto* result = arena.Fill(response.results, orders->spawned.size());
  for (const Spawned& spawned : orders->spawned) {
    if (spawned.code != kOk) ++failed;
    *result++ = {MakeResult(spawned.code, spawned.problem, arena), arena.Copy(spawned.name)};
  }
  const std::string problem = std::to_string(failed) + " of " + std::to_string(orders->spawned.size()) + " failed";
  response.result = MakeResult(failed == 0 ? kOk : kEntitiesSpawnFailed, failed == 0 ? "" : problem, arena);
  orders->call.Respond(response);
}

void OnSpawnEntities(SimulationContext& context, const SpawnEntitiesCall& call, const SpawnEntitiesRequest& request) {
  const auto orders = std::make_shared<SpawnOrders>(SpawnOrders{call});
  for (const auto& order : dds::Elements(request.spawn_requests)) {
    orders->orders.push_back({dds::Text(order.name), order.allow_renaming, dds::Text(order.entity_resource.uri),
                              dds::Text(order.entity_resource.resource_string), dds::Text(order.entity_namespace),
                              PoseFromRos(order.initial_pose.header.frame_id, order.initial_pose.pose)});
  }
  SpawnNext(context, orders);
}

}  // namespace

void AddEntityEdits(ServiceSet& services) {
  services.Add("delete_entity", &OnDeleteEntity);
  if (services.has_interfaces_2()) {
    services.Add("set_entity_state", &OnSetEntityState<NewSetEntityStateRequest>);
  } else {
    services.Add("set_entity_state", &OnSetEntityState<SetEntityStateRequest>);
  }
  services.Add("spawn_entity", &OnSpawnEntity);
  services.Add("spawn_entities", &OnSpawnEntities);
}

}  // namespace troupe
