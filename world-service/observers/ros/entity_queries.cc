#include "world-service/observers/ros/entity_queries.h"

#include <algorithm>
#include <utility>

#include "ros/messages/convert.h"
#include "ros/messages/names.h"
#include "world-service/observers/ros/entity_filter.h"

namespace troupe {

using ros::RosCaller;

void EntityQueries::Open(const ros::RosNode& node, const std::string& prefix, ros::Distribution distribution) {
  get_entities_.Open(node, prefix + "get_entities", Bind(&EntityQueries::OnGetEntities));
  get_states_.Open(node, prefix + "get_entities_states", Bind(&EntityQueries::OnGetStates));
  get_state_.Open(node, prefix + "get_entity_state", Bind(&EntityQueries::OnGetState));
  get_info_.Open(node, prefix + "get_entity_info", Bind(&EntityQueries::OnGetInfo));
  get_bounds_.Open(node, prefix + "get_entity_bounds", Bind(&EntityQueries::OnGetBounds));
  set_info_.Open(node, prefix + "set_entity_info", Bind(&EntityQueries::OnSetInfo));
  if (distribution == ros::Distribution::kRolling) {
    get_rolling_spawnables_.Open(node, prefix + "get_spawnables", Bind(&EntityQueries::OnGetRollingSpawnables));
  } else {
    get_spawnables_.Open(node, prefix + "get_spawnables", Bind(&EntityQueries::OnGetSpawnables));
  }
}

void EntityQueries::Close() {
  get_entities_.Close();
  get_states_.Close();
  get_state_.Close();
  get_info_.Close();
  get_bounds_.Close();
  set_info_.Close();
  get_spawnables_.Close();
  get_rolling_spawnables_.Close();
}

simulation_interfaces_msg_dds__EntityState_ EntityQueries::StateOf(const EntityReport& entity, Tick tick,
                                                                   dds::WireArena& arena) const {
  simulation_interfaces_msg_dds__EntityState_ state{};
  const ros::Time stamp = ros::ToTime(tick, context().scene()->world().interval_ns);
  state.header = ros::MakeHeader(stamp, ros::kMapFrame, arena);
  state.pose = ros::ToMessage(entity.X_WE);
  state.twist = ros::ToMessage(entity.twist);
  return state;
}

// Answers with the names of the entities that pass the filter, and with the fields that `add` fills.
template <typename Response, typename Slot, typename Add>
void EntityQueries::AnswerMatching(const RosCaller& caller,
                                   const simulation_interfaces_msg_dds__EntityFilters_& filters, Slot& slot, Add add) {
  Result<EntityFilter> made = EntityFilter::Make(filters);
  if (!made.ok()) {
    dds::WireArena arena;
    Response response{};
    response.result = MakeResult(ResultCode::kUnsupported, made.error().message, arena);
    return slot.Respond(caller, response);
  }
  const auto filter = std::make_shared<const EntityFilter>(std::move(made).value());
  ControlRequest query;
  query.command = ControlCommand::kEntities;
  query.with_boxes = filter->has_bounds();
  Ask(query, [caller, filter, &slot, add](EntityQueries& self, const ControlReply& reply) {
    dds::WireArena arena;
    Response response{};
    response.result = MakeResult(reply, arena);
    std::vector<std::string> names;
    std::vector<EntityReport> matching;
    for (const EntityReport& entity : reply.entities) {
      const std::string name = self.context().RosNameOf(entity);
      const EntityInfo info = self.context().InfoOf(entity);
      if (!filter->Matches(name, entity, info.category, info.tags)) continue;
      names.push_back(name);
      matching.push_back(entity);
    }
    arena.FillStrings(response.entities, names);
    add(self, reply, matching, response, arena);
    slot.Respond(caller, response);
  });
}

void EntityQueries::OnGetEntities(const RosCaller& caller,
                                  const simulation_interfaces_srv_dds__GetEntities_Request_& request) {
  AnswerMatching<simulation_interfaces_srv_dds__GetEntities_Response_>(
      caller, request.filters, get_entities_,
      [](const EntityQueries&, const ControlReply&, const std::vector<EntityReport>&, auto&, dds::WireArena&) {});
}

void EntityQueries::OnGetStates(const RosCaller& caller,
                                const simulation_interfaces_srv_dds__GetEntitiesStates_Request_& request) {
  AnswerMatching<simulation_interfaces_srv_dds__GetEntitiesStates_Response_>(
      caller, request.filters, get_states_,
      [](const EntityQueries& self, const ControlReply& reply, const std::vector<EntityReport>& matching,
         auto& response, dds::WireArena& arena) {
        auto* state = arena.Fill(response.states, matching.size());
        for (const EntityReport& entity : matching) *state++ = self.StateOf(entity, reply.tick, arena);
      });
}

void EntityQueries::OnGetState(const RosCaller& caller,
                               const simulation_interfaces_srv_dds__GetEntityState_Request_& request) {
  const std::string name = dds::Text(request.entity);
  FindEntity(name, [caller, name](EntityQueries& self, const ControlReply& reply, const EntityReport* entity) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetEntityState_Response_ response{};
    response.result = MakeFound(entity, name, arena);
    response.state = self.StateOf(entity != nullptr ? *entity : EntityReport{}, reply.tick, arena);
    self.get_state_.Respond(caller, response);
  });
}

void EntityQueries::OnGetInfo(const RosCaller& caller,
                              const simulation_interfaces_srv_dds__GetEntityInfo_Request_& request) {
  const std::string name = dds::Text(request.entity);
  FindEntity(name, [caller, name](EntityQueries& self, const ControlReply&, const EntityReport* entity) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetEntityInfo_Response_ response{};
    response.result = MakeFound(entity, name, arena);
    const EntityInfo info = entity != nullptr ? self.context().InfoOf(*entity) : EntityInfo();
    response.info.category.category = info.category;
    response.info.description = arena.Copy(info.description);
    arena.FillStrings(response.info.tags, info.tags);
    self.get_info_.Respond(caller, response);
  });
}

void EntityQueries::OnSetInfo(const RosCaller& caller,
                              const simulation_interfaces_srv_dds__SetEntityInfo_Request_& request) {
  const std::string name = dds::Text(request.entity);
  const EntityInfo info{request.info.category.category, dds::Text(request.info.description),
                        dds::Strings(request.info.tags)};
  FindEntity(name, [caller, name, info](EntityQueries& self, const ControlReply&, const EntityReport* entity) {
    if (entity != nullptr) self.context().SetInfo(*entity, info);
    dds::WireArena arena;
    simulation_interfaces_srv_dds__SetEntityInfo_Response_ response{};
    response.result = MakeFound(entity, name, arena);
    self.set_info_.Respond(caller, response);
  });
}

void EntityQueries::OnGetBounds(const RosCaller& caller,
                                const simulation_interfaces_srv_dds__GetEntityBounds_Request_& request) {
  constexpr std::uint8_t kTypeBox = 1;
  const std::string ros_name = dds::Text(request.entity);
  ControlRequest query;
  query.command = ControlCommand::kEntities;
  query.with_boxes = true;
  Ask(query, [caller, ros_name](EntityQueries& self, const ControlReply& reply) {
    const auto found = std::find_if(reply.entities.begin(), reply.entities.end(), [&](const EntityReport& entity) {
      return self.context().RosNameOf(entity) == ros_name;
    });
    const EntityReport* const entity = found != reply.entities.end() ? &*found : nullptr;
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetEntityBounds_Response_ response{};
    response.result = MakeFound(entity, ros_name, arena);
    if (entity != nullptr && entity->box != EntityBox()) {
      const EntityBox& box = entity->box;
      response.bounds.type = kTypeBox;
      auto* corners = arena.Fill(response.bounds.points, 2);
      corners[0] = {box.max_x, box.max_y, box.max_z};
      corners[1] = {box.min_x, box.min_y, box.min_z};
    }
    self.get_bounds_.Respond(caller, response);
  });
}

void EntityQueries::OnGetSpawnables(const RosCaller& caller,
                                    const simulation_interfaces_srv_dds__GetSpawnables_Request_&) {
  AnswerSpawnables<simulation_interfaces_srv_dds__GetSpawnables_Response_>(
      caller, get_spawnables_, [](auto& spawnable) -> char*& { return spawnable.uri; });
}

void EntityQueries::OnGetRollingSpawnables(const RosCaller& caller,
                                           const simulation_interfaces_srv_dds__GetSpawnables_Request_&) {
  AnswerSpawnables<rolling_simulation_interfaces_srv_dds__GetSpawnables_Response_>(
      caller, get_rolling_spawnables_, [](auto& spawnable) -> char*& { return spawnable.entity_resource.uri; });
}

template <typename Response, typename Slot, typename UriOf>
void EntityQueries::AnswerSpawnables(const RosCaller& caller, Slot& slot, UriOf uri_of) {
  Ask(ControlCommand::kSpawnables, [caller, &slot, uri_of](EntityQueries&, const ControlReply& reply) {
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

}  // namespace troupe
