#include "world-service/ros/entity_services.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "common/ros/convert.h"
#include "common/ros/names.h"
#include "world-service/ros/entity_filter.h"
#include "world-service/ros/entity_pose.h"
#include "world-service/ros/simulation_context.h"

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
constexpr std::uint8_t kInvalidSpawnPose = 109;
// Of LoadWorld.
constexpr std::uint8_t kUnsupportedWorldFormat = 101;
constexpr std::uint8_t kNoWorldResource = 102;

std::string PathOf(const char* uri) {
  const std::string text = dds::Text(uri);
  constexpr std::string_view kScheme = "file://";
  return text.starts_with(kScheme) ? text.substr(kScheme.size()) : text;
}

bool IsZero(const geometry_msgs_msg_dds__Twist_& twist) {
  return twist.linear.x == 0.0 && twist.linear.y == 0.0 && twist.linear.z == 0.0 && twist.angular.x == 0.0 &&
         twist.angular.y == 0.0 && twist.angular.z == 0.0;
}

ControlRequest Entities() {
  ControlRequest request;
  request.command = ControlCommand::kEntities;
  return request;
}

}  // namespace

class EntityServices::Services : public std::enable_shared_from_this<Services> {
 public:
  explicit Services(std::shared_ptr<const SimulationContext> context) : context_(std::move(context)) {}

  void Open(const ros::RosNode& node, const std::string& name, ros::Distribution distribution) {
    const std::string prefix = name + "/";
    const auto bind = [this](auto method) {
      return [this, method](const RosCaller& caller, const auto& request) { (this->*method)(caller, request); };
    };
    entities_.Open(node, prefix + "get_entities", bind(&Services::OnGetEntities));
    states_.Open(node, prefix + "get_entities_states", bind(&Services::OnGetStates));
    state_.Open(node, prefix + "get_entity_state", bind(&Services::OnGetState));
    info_.Open(node, prefix + "get_entity_info", bind(&Services::OnGetInfo));
    spawn_.Open(node, prefix + "spawn_entity", bind(&Services::OnSpawn));
    delete_.Open(node, prefix + "delete_entity", bind(&Services::OnDelete));
    load_.Open(node, prefix + "load_world", bind(&Services::OnLoad));
    reset_.Open(node, prefix + "reset_simulation", bind(&Services::OnReset));
    plain_reset_.Open(node, "/reset", bind(&Services::OnPlainReset));
    if (distribution == ros::Distribution::kRolling) {
      new_set_state_.Open(node, prefix + "set_entity_state", bind(&Services::OnNewSetState));
      new_spawnables_.Open(node, prefix + "get_spawnables", bind(&Services::OnNewSpawnables));
    } else {
      set_state_.Open(node, prefix + "set_entity_state", bind(&Services::OnSetState));
      spawnables_.Open(node, prefix + "get_spawnables", bind(&Services::OnSpawnables));
    }
  }

  void Close() {
    entities_.Close();
    states_.Close();
    state_.Close();
    info_.Close();
    spawn_.Close();
    delete_.Close();
    load_.Close();
    reset_.Close();
    plain_reset_.Close();
    new_set_state_.Close();
    new_spawnables_.Close();
    set_state_.Close();
    spawnables_.Close();
  }

 private:
  template <typename Answered>
  void Ask(const ControlRequest& request, Answered answered) {
    context_->Ask(request, weak_from_this(), std::move(answered));
  }

  simulation_interfaces_msg_dds__EntityState_ StateOf(const EntityReport& entity, Tick tick,
                                                      dds::WireArena& arena) const {
    simulation_interfaces_msg_dds__EntityState_ state{};
    const ros::Time stamp = ros::ToTime(tick, context_->scene()->world().interval_ns);
    state.header = ros::MakeHeader(stamp, ros::kMapFrame, arena);
    state.pose = ros::ToMessage(entity.X_WE);
    state.twist = ros::ToMessage(entity.twist);
    return state;
  }

  // Calls respond(self, reply, entity) with the entity called so, null if there is none.
  template <typename Respond>
  void Find(const std::string& ros_name, Respond respond) {
    Ask(Entities(), [ros_name, respond](Services& self, const ControlReply& reply) {
      for (const EntityReport& entity : reply.entities) {
        if (self.context_->RosNameOf(entity) == ros_name) return respond(self, reply, &entity);
      }
      respond(self, reply, nullptr);
    });
  }

  void OnGetEntities(const RosCaller& caller, const simulation_interfaces_srv_dds__GetEntities_Request_& request) {
    WithMatching<simulation_interfaces_srv_dds__GetEntities_Response_>(
        caller, request.filters, entities_,
        [](const Services&, const ControlReply&, const std::vector<EntityReport>&, auto&, dds::WireArena&) {});
  }

  void OnGetStates(const RosCaller& caller, const simulation_interfaces_srv_dds__GetEntitiesStates_Request_& request) {
    WithMatching<simulation_interfaces_srv_dds__GetEntitiesStates_Response_>(
        caller, request.filters, states_,
        [](const Services& self, const ControlReply& reply, const std::vector<EntityReport>& matching, auto& response,
           dds::WireArena& arena) {
          auto* state = arena.Fill(response.states, matching.size());
          for (const EntityReport& entity : matching) *state++ = self.StateOf(entity, reply.tick, arena);
        });
  }

  // Answers with the names of what the filter lets pass, and what `add` has to say of it.
  template <typename Response, typename Slot, typename Add>
  void WithMatching(const RosCaller& caller, const simulation_interfaces_msg_dds__EntityFilters_& filters, Slot& slot,
                    Add add) {
    Result<EntityFilter> made = EntityFilter::Make(filters);
    if (!made.ok()) {
      dds::WireArena arena;
      Response response{};
      response.result = MakeResult(ResultCode::kUnsupported, made.error().message, arena);
      return slot.Respond(caller, response);
    }
    const auto filter = std::make_shared<const EntityFilter>(std::move(made).value());
    Ask(Entities(), [caller, filter, &slot, add](Services& self, const ControlReply& reply) {
      dds::WireArena arena;
      Response response{};
      response.result = MakeResult(reply, arena);
      std::vector<std::string> names;
      std::vector<EntityReport> matching;
      for (const EntityReport& entity : reply.entities) {
        const std::string name = self.context_->RosNameOf(entity);
        if (!filter->Matches(name, entity.kind)) continue;
        names.push_back(name);
        matching.push_back(entity);
      }
      arena.FillStrings(response.entities, names);
      add(self, reply, matching, response, arena);
      slot.Respond(caller, response);
    });
  }

  void OnGetState(const RosCaller& caller, const simulation_interfaces_srv_dds__GetEntityState_Request_& request) {
    const std::string name = dds::Text(request.entity);
    Find(name, [caller, name](Services& self, const ControlReply& reply, const EntityReport* entity) {
      dds::WireArena arena;
      simulation_interfaces_srv_dds__GetEntityState_Response_ response{};
      response.result = MakeFound(entity, name, arena);
      response.state = self.StateOf(entity != nullptr ? *entity : EntityReport{}, reply.tick, arena);
      self.state_.Respond(caller, response);
    });
  }

  void OnGetInfo(const RosCaller& caller, const simulation_interfaces_srv_dds__GetEntityInfo_Request_& request) {
    const std::string name = dds::Text(request.entity);
    Find(name, [caller, name](Services& self, const ControlReply&, const EntityReport* entity) {
      dds::WireArena arena;
      simulation_interfaces_srv_dds__GetEntityInfo_Response_ response{};
      response.result = MakeFound(entity, name, arena);
      response.info.description = arena.Copy(entity != nullptr ? entity->type : "");
      if (entity != nullptr) response.info.category.category = CategoryOf(entity->kind);
      self.info_.Respond(caller, response);
    });
  }

  static simulation_interfaces_msg_dds__Result_ MakeFound(const EntityReport* entity, const std::string& name,
                                                          dds::WireArena& arena) {
    if (entity != nullptr) return MakeResult(ResultCode::kOk, "", arena);
    return MakeResult(ResultCode::kNotFound, "no entity '" + name + "'", arena);
  }

  void OnSetState(const RosCaller& caller, const simulation_interfaces_srv_dds__SetEntityState_Request_& request) {
    SetState(caller, request.entity, request.state, true, !IsZero(request.state.twist), set_state_);
  }
  void OnNewSetState(const RosCaller& caller,
                     const rolling_simulation_interfaces_srv_dds__SetEntityState_Request_& request) {
    const bool moves = request.set_twist && !IsZero(request.state.twist);
    SetState(caller, request.entity, request.state, request.set_pose, moves || request.set_acceleration,
             new_set_state_);
  }

  template <typename Slot>
  void SetState(const RosCaller& caller, const char* entity_name,
                const simulation_interfaces_msg_dds__EntityState_& state, bool set_pose, bool moves, Slot& slot) {
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
    Find(name, [=](Services& self, const ControlReply&, const EntityReport* entity) {
      if (entity == nullptr) {
        return answer(static_cast<std::uint8_t>(ResultCode::kNotFound), "no entity '" + name + "'");
      }
      if (!set_pose) return answer(kOk, "");
      ControlRequest move;
      move.command = ControlCommand::kSetPose;
      move.name = entity->name;
      move.pose = pose.value();
      self.Ask(move, [answer](Services&, const ControlReply& reply) {
        answer(reply.done ? kOk : kInvalidStatePose, reply.problem);
      });
    });
  }

  void AnswerSpawn(const RosCaller& caller, std::uint8_t code, const std::string& problem, const std::string& name) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__SpawnEntity_Response_ response{};
    response.result = MakeResult(code, problem, arena);
    response.entity_name = arena.Copy(name);
    spawn_.Respond(caller, response);
  }

  void OnSpawn(const RosCaller& caller, const simulation_interfaces_srv_dds__SpawnEntity_Request_& request) {
    ControlRequest spawn;
    spawn.command = ControlCommand::kSpawn;
    spawn.source = PathOf(request.uri);
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
    Find(spawn.name, [caller, spawn](Services& self, const ControlReply&, const EntityReport* other) {
      if (other != nullptr && !spawn.rename) {
        return self.AnswerSpawn(caller, kNameNotUnique, "the name '" + spawn.name + "' is in use", "");
      }
      self.Ask(spawn, [caller](Services& services, const ControlReply& reply) {
        const ResultCode code = reply.done ? ResultCode::kOk : ResultCode::kOperationFailed;
        const std::string name = reply.entities.empty() ? "" : services.context_->RosNameOf(reply.entities.front());
        services.AnswerSpawn(caller, static_cast<std::uint8_t>(code), reply.problem, name);
      });
    });
  }

  void OnDelete(const RosCaller& caller, const simulation_interfaces_srv_dds__DeleteEntity_Request_& request) {
    const std::string name = dds::Text(request.entity);
    Find(name, [caller, name](Services& self, const ControlReply&, const EntityReport* entity) {
      if (entity == nullptr) {
        dds::WireArena arena;
        simulation_interfaces_srv_dds__DeleteEntity_Response_ response{};
        response.result = MakeFound(entity, name, arena);
        return self.delete_.Respond(caller, response);
      }
      ControlRequest removal;
      removal.command = ControlCommand::kDelete;
      removal.name = entity->name;
      self.Ask(removal, [caller](Services& services, const ControlReply& reply) {
        dds::WireArena arena;
        simulation_interfaces_srv_dds__DeleteEntity_Response_ response{};
        response.result = MakeResult(reply, arena);
        services.delete_.Respond(caller, response);
      });
    });
  }

  void OnSpawnables(const RosCaller& caller, const simulation_interfaces_srv_dds__GetSpawnables_Request_&) {
    AnswerSpawnables<simulation_interfaces_srv_dds__GetSpawnables_Response_>(
        caller, spawnables_, [](auto& spawnable) -> char*& { return spawnable.uri; });
  }
  void OnNewSpawnables(const RosCaller& caller, const simulation_interfaces_srv_dds__GetSpawnables_Request_&) {
    AnswerSpawnables<rolling_simulation_interfaces_srv_dds__GetSpawnables_Response_>(
        caller, new_spawnables_, [](auto& spawnable) -> char*& { return spawnable.entity_resource.uri; });
  }
  template <typename Response, typename Slot, typename UriOf>
  void AnswerSpawnables(const RosCaller& caller, Slot& slot, UriOf uri_of) {
    ControlRequest list;
    list.command = ControlCommand::kSpawnables;
    Ask(list, [caller, &slot, uri_of](Services&, const ControlReply& reply) {
      dds::WireArena arena;
      Response response{};
      response.result = MakeResult(reply, arena);
      auto* spawnable = arena.Fill(response.spawnables, reply.entities.size());
      for (const EntityReport& model : reply.entities) {
        uri_of(*spawnable) = arena.Copy(model.name);
        spawnable->description = arena.Copy(model.type);
        ++spawnable;
      }
      slot.Respond(caller, response);
    });
  }

  void OnLoad(const RosCaller& caller, const simulation_interfaces_srv_dds__LoadWorld_Request_& request) {
    ControlRequest load;
    load.command = ControlCommand::kLoadWorld;
    load.source = PathOf(request.uri);
    if (load.source.empty()) {
      const bool has_text = !dds::Text(request.resource_string).empty();
      return AnswerLoad(caller, has_text ? kUnsupportedWorldFormat : kNoWorldResource, "found no uri, expected a file",
                        "", "");
    }
    Ask(load, [caller, path = load.source](Services& self, const ControlReply& reply) {
      const ResultCode code = reply.done ? ResultCode::kOk : ResultCode::kOperationFailed;
      self.AnswerLoad(caller, static_cast<std::uint8_t>(code), reply.problem,
                      reply.done ? self.context_->scene()->world().name : "", path);
    });
  }
  void AnswerLoad(const RosCaller& caller, std::uint8_t code, const std::string& problem, const std::string& world,
                  const std::string& path) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__LoadWorld_Response_ response{};
    response.result = MakeResult(code, problem, arena);
    response.world.name = arena.Copy(world);
    response.world.world_resource.uri = arena.Copy(path);
    load_.Respond(caller, response);
  }

  static ControlRequest Reset(std::uint8_t scopes) {
    ControlRequest request;
    request.command = ControlCommand::kReset;
    request.scopes = scopes;
    return request;
  }
  void OnReset(const RosCaller& caller, const simulation_interfaces_srv_dds__ResetSimulation_Request_& request) {
    Ask(Reset(request.scope == 0 ? kResetAll : request.scope), [caller](Services& self, const ControlReply& reply) {
      dds::WireArena arena;
      simulation_interfaces_srv_dds__ResetSimulation_Response_ response{};
      response.result = MakeResult(reply, arena);
      self.reset_.Respond(caller, response);
    });
  }
  // It cannot say that something went wrong.
  void OnPlainReset(const RosCaller& caller, const std_srvs_srv_dds__Empty_Request_&) {
    Ask(Reset(kResetAll), [caller](Services& self, const ControlReply&) {
      std_srvs_srv_dds__Empty_Response_ response{};
      self.plain_reset_.Respond(caller, response);
    });
  }

  const std::shared_ptr<const SimulationContext> context_;
  ServiceSlot<simulation_interfaces_srv_dds__GetEntities_Request_, simulation_interfaces_srv_dds__GetEntities_Response_>
      entities_;
  ServiceSlot<simulation_interfaces_srv_dds__GetEntitiesStates_Request_,
              simulation_interfaces_srv_dds__GetEntitiesStates_Response_>
      states_;
  ServiceSlot<simulation_interfaces_srv_dds__GetEntityState_Request_,
              simulation_interfaces_srv_dds__GetEntityState_Response_>
      state_;
  ServiceSlot<simulation_interfaces_srv_dds__GetEntityInfo_Request_,
              simulation_interfaces_srv_dds__GetEntityInfo_Response_>
      info_;
  ServiceSlot<simulation_interfaces_srv_dds__SpawnEntity_Request_, simulation_interfaces_srv_dds__SpawnEntity_Response_>
      spawn_;
  ServiceSlot<simulation_interfaces_srv_dds__DeleteEntity_Request_,
              simulation_interfaces_srv_dds__DeleteEntity_Response_>
      delete_;
  ServiceSlot<simulation_interfaces_srv_dds__LoadWorld_Request_, simulation_interfaces_srv_dds__LoadWorld_Response_>
      load_;
  ServiceSlot<simulation_interfaces_srv_dds__ResetSimulation_Request_,
              simulation_interfaces_srv_dds__ResetSimulation_Response_>
      reset_;
  ServiceSlot<std_srvs_srv_dds__Empty_Request_, std_srvs_srv_dds__Empty_Response_> plain_reset_;
  // Either these or the next two are open.
  ServiceSlot<simulation_interfaces_srv_dds__SetEntityState_Request_,
              simulation_interfaces_srv_dds__SetEntityState_Response_>
      set_state_;
  ServiceSlot<simulation_interfaces_srv_dds__GetSpawnables_Request_,
              simulation_interfaces_srv_dds__GetSpawnables_Response_>
      spawnables_;
  ServiceSlot<rolling_simulation_interfaces_srv_dds__SetEntityState_Request_,
              simulation_interfaces_srv_dds__SetEntityState_Response_>
      new_set_state_;
  ServiceSlot<simulation_interfaces_srv_dds__GetSpawnables_Request_,
              rolling_simulation_interfaces_srv_dds__GetSpawnables_Response_>
      new_spawnables_;
};

EntityServices::EntityServices(const ros::RosNode& node, const std::string& name, ros::Distribution distribution,
                               std::shared_ptr<const SimulationContext> context)
    : services_(std::make_shared<Services>(std::move(context))) {
  services_->Open(node, name, distribution);
}

EntityServices::~EntityServices() {
  services_->Close();
}

}  // namespace troupe
