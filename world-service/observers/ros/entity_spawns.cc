#include "world-service/observers/ros/entity_spawns.h"

#include <utility>

#include "ros/messages/robot_in_ros.h"
#include "world-service/observers/ros/entity_pose.h"
#include "world-service/observers/ros/resource_path.h"

namespace troupe {
namespace {

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
