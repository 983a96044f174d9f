// The services that report entities, their states and the models that can be spawned.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ros/messages/convert.h"
#include "ros/messages/names.h"
#include "world-service/observers/ros/request_values.h"
#include "world-service/observers/ros/simulation_context.h"

namespace troupe {
namespace {

TROUPE_SIMULATION_SERVICE(GetEntities);
TROUPE_SIMULATION_SERVICE(GetEntitiesStates);
TROUPE_SIMULATION_SERVICE(GetEntityState);
TROUPE_SIMULATION_SERVICE(GetEntityInfo);
TROUPE_SIMULATION_SERVICE(SetEntityInfo);
TROUPE_SIMULATION_SERVICE(GetEntityBounds);
TROUPE_SIMULATION_SERVICE(GetSpawnables);
constexpr std::uint8_t kTypeBox = 1;  // of Bounds

using NewGetSpawnablesResponse = rolling_simulation_interfaces_srv_dds__GetSpawnables_Response_;  // of 2.x

simulation_interfaces_msg_dds__EntityState_ StateOf(const SimulationContext& context, const EntityReport& entity,
                                                    Tick tick, dds::WireArena& arena) {
  simulation_interfaces_msg_dds__EntityState_ state{};
  const ros::Time stamp = ros::ToTime(tick, context.scene()->world().interval_ns);
  state.header = ros::MakeHeader(stamp, ros::kMapFrame, arena);
  state.pose = ros::ToMessage(entity.X_WE);
  state.twist = ros::ToMessage(entity.twist);
  return state;
}

// Answers with the names of the entities that pass the filter, and with the fields that `add` fills.
template <typename Request, typename Response, typename Add>
void AnswerMatching(SimulationContext& context, const Call<Request, Response>& call, const Request& request, Add add) {
  Result<EntityFilter> made = EntityFilter::Make(request.filters);
  if (!made.ok()) return call.Answer(ResultCode::kUnsupported, made.error().message);
  const auto filter = std::make_shared<const EntityFilter>(std::move(made).value());
  context.Ask(control::Entities{.with_boxes = filter->has_bounds()},
              [call, filter, add](SimulationContext& self, const ControlReply& reply) {
                dds::WireArena arena;
                Response response{};
                response.result = MakeResult(reply, arena);
                std::vector<std::string> names;
                std::vector<EntityReport> matching;
                for (const EntityReport& entity : reply.entities) {
                  const std::string name = self.RosNameOf(entity);
                  const EntityInfo info = self.InfoOf(entity);
                  if (!filter->Matches(name, entity, info.category, info.tags)) continue;
                  names.push_back(name);
                  matching.push_back(entity);
                }
                arena.FillStrings(response.entities, names);
                add(self, reply, matching, response, arena);
                call.Respond(response);
              });
}

void OnGetEntities(SimulationContext& context, const GetEntitiesCall& call, const GetEntitiesRequest& request) {
  AnswerMatching(context, call, request, [](const auto&...) {});
}

void OnGetEntitiesStates(SimulationContext& context, const GetEntitiesStatesCall& call,
                         const GetEntitiesStatesRequest& request) {
  AnswerMatching(context, call, request,
                 [](const SimulationContext& self, const ControlReply& reply, const std::vector<EntityReport>& matching,
                    auto& response, dds::WireArena& arena) {
                   auto* state = arena.Fill(response.states, matching.size());
                   for (const EntityReport& entity : matching) *state++ = StateOf(self, entity, reply.tick, arena);
                 });
}

// Answers about one entity, with the fields that `add` fills if it exists.
template <typename Request, typename Response, typename Add>
void AnswerOne(SimulationContext& context, const Call<Request, Response>& call, const Request& request, Add add) {
  const std::string name = dds::Text(request.entity);
  const auto answer = [call, name, add](SimulationContext& self, const ControlReply& reply,
                                        const EntityReport* entity) {
    dds::WireArena arena;
    Response response{};
    response.result = MakeFound(entity, name, arena);
    add(self, reply, entity != nullptr ? *entity : EntityReport{}, response, arena);
    call.Respond(response);
  };
  context.FindEntity(name, answer, std::is_same_v<Request, GetEntityBoundsRequest>);
}

void OnGetEntityState(SimulationContext& context, const GetEntityStateCall& call,
                      const GetEntityStateRequest& request) {
  AnswerOne(context, call, request,
            [](const SimulationContext& self, const ControlReply& reply, const EntityReport& entity, auto& response,
               dds::WireArena& arena) { response.state = StateOf(self, entity, reply.tick, arena); });
}

void OnGetEntityInfo(SimulationContext& context, const GetEntityInfoCall& call, const GetEntityInfoRequest& request) {
  AnswerOne(context, call, request,
            [](const SimulationContext& self, const ControlReply&, const EntityReport& entity, auto& response,
               dds::WireArena& arena) {
              const EntityInfo info = entity.name.empty() ? EntityInfo() : self.InfoOf(entity);
              response.info.category.category = info.category;
              response.info.description = arena.Copy(info.description);
              arena.FillStrings(response.info.tags, info.tags);
            });
}

void OnSetEntityInfo(SimulationContext& context, const SetEntityInfoCall& call, const SetEntityInfoRequest& request) {
  const EntityInfo info{request.info.category.category, dds::Text(request.info.description),
                        dds::Strings(request.info.tags)};
  AnswerOne(context, call, request,
            [info](SimulationContext& self, const ControlReply&, const EntityReport& entity, const auto&...) {
              if (!entity.name.empty()) self.SetInfo(entity, info);
            });
}

void OnGetEntityBounds(SimulationContext& context, const GetEntityBoundsCall& call,
                       const GetEntityBoundsRequest& request) {
  AnswerOne(context, call, request,
            [](const SimulationContext&, const ControlReply&, const EntityReport& entity, auto& response,
               dds::WireArena& arena) {
              const EntityBox& box = entity.box;
              if (box == EntityBox()) return;
              response.bounds.type = kTypeBox;
              auto* corners = arena.Fill(response.bounds.points, 2);
              corners[0] = {box.area.max_x, box.area.max_y, box.z.max};
              corners[1] = {box.area.min_x, box.area.min_y, box.z.min};
            });
}

char*& UriOf(simulation_interfaces_msg_dds__Spawnable_& spawnable) {
  return spawnable.uri;
}
char*& UriOf(rolling_simulation_interfaces_msg_dds__Spawnable_& spawnable) {
  return spawnable.entity_resource.uri;
}

template <typename Response>
void ListSpawnables(SimulationContext& context, const Call<GetSpawnablesRequest, Response>& call,
                    const GetSpawnablesRequest&) {
  context.Ask(control::Spawnables(), [call](SimulationContext&, const ControlReply& reply) {
    dds::WireArena arena;
    Response response{};
    response.result = MakeResult(reply, arena);
    auto* spawnable = arena.Fill(response.spawnables, reply.entities.size());
    for (const EntityReport& model : reply.entities) {
      UriOf(*spawnable) = arena.Copy(model.name);
      spawnable->description = arena.Copy(model.type);
      ++spawnable;
    }
    call.Respond(response);
  });
}

}  // namespace

void AddEntityQueries(ServiceSet& services) {
  services.Add("get_entities", &OnGetEntities);
  services.Add("get_entities_states", &OnGetEntitiesStates);
  services.Add("get_entity_state", &OnGetEntityState);
  services.Add("get_entity_info", &OnGetEntityInfo);
  services.Add("get_entity_bounds", &OnGetEntityBounds);
  services.Add("set_entity_info", &OnSetEntityInfo);
  if (services.has_interfaces_2()) {
    services.Add("get_spawnables", &ListSpawnables<NewGetSpawnablesResponse>);
  } else {
    services.Add("get_spawnables", &ListSpawnables<GetSpawnablesResponse>);
  }
}

}  // namespace troupe
