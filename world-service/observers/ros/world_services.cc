#include "world-service/observers/ros/world_services.h"

#include <utility>

#include "ros/messages/convert.h"
#include "world-service/observers/ros/entity_filter.h"
#include "world-service/observers/ros/request_values.h"

namespace troupe {
namespace {

using ros::RosCaller;

// Of LoadWorld.
constexpr std::uint8_t kUnsupportedWorldFormat = 101;
constexpr std::uint8_t kNoWorldResource = 102;
constexpr std::uint8_t kMalformedWorld = 103;

std::uint8_t LoadCode(const ControlReply& reply, const std::string& path) {
  if (reply.done) return static_cast<std::uint8_t>(ResultCode::kOk);
  if (!path.empty() && HasOtherFormat(path, {".world", ".json", ".yaml", ".yml"})) return kUnsupportedWorldFormat;
  if (reply.problem_code == ErrorCode::kMalformed) return kMalformedWorld;
  return static_cast<std::uint8_t>(ResultCode::kOperationFailed);
}

ControlRequest ResetRequest(std::uint8_t scopes) {
  ControlRequest request;
  request.command = ControlCommand::kReset;
  request.scopes = scopes;
  return request;
}

}  // namespace

void WorldServices::Open(const ros::RosNode& node, const std::string& prefix) {
  load_.Open(node, prefix + "load_world", Bind(&WorldServices::OnLoad));
  unload_.Open(node, prefix + "unload_world", Bind(&WorldServices::OnUnload));
  reset_.Open(node, prefix + "reset_simulation", Bind(&WorldServices::OnReset));
  plain_reset_.Open(node, "/reset", Bind(&WorldServices::OnPlainReset));
}

void WorldServices::Close() {
  load_.Close();
  unload_.Close();
  reset_.Close();
  plain_reset_.Close();
}

void WorldServices::AnswerLoad(const RosCaller& caller, std::uint8_t code, const std::string& problem,
                               const std::string& world, const std::string& path) {
  dds::WireArena arena;
  simulation_interfaces_srv_dds__LoadWorld_Response_ response{};
  response.result = MakeResult(code, problem, arena);
  response.world.name = arena.Copy(world);
  response.world.world_resource.uri = arena.Copy(path);
  load_.Respond(caller, response);
}

void WorldServices::OnLoad(const RosCaller& caller, const simulation_interfaces_srv_dds__LoadWorld_Request_& request) {
  ControlRequest load;
  load.command = ControlCommand::kLoadWorld;
  load.source = ResourcePath(request.uri);
  if (load.source.empty()) {
    load.text = dds::Text(request.resource_string);
    if (load.text.empty()) return AnswerLoad(caller, kNoWorldResource, "found no uri, expected a file", "", "");
    if (IsOtherText(load.text)) {
      return AnswerLoad(caller, kUnsupportedWorldFormat, "found a text of XML, expected a Stage world or a scenario",
                        "", "");
    }
  }
  Ask(load, [caller, path = load.source](WorldServices& self, const ControlReply& reply) {
    self.AnswerLoad(caller, LoadCode(reply, path), reply.problem,
                    reply.done ? self.context().scene()->world().name : "", path);
  });
}

void WorldServices::OnUnload(const RosCaller& caller, const simulation_interfaces_srv_dds__UnloadWorld_Request_&) {
  const auto answer = [caller](WorldServices& self, std::uint8_t code, const std::string& problem) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__UnloadWorld_Response_ response{};
    response.result = MakeResult(code, problem, arena);
    self.unload_.Respond(caller, response);
  };
  if (!context().has_world()) return answer(*this, kNoWorldLoaded, "no world is loaded");
  ControlRequest unload;
  unload.command = ControlCommand::kLoadWorld;
  Ask(unload, [answer](WorldServices& self, const ControlReply& reply) {
    answer(self, static_cast<std::uint8_t>(CodeOf(reply)), reply.problem);
  });
}

void WorldServices::OnReset(const RosCaller& caller,
                            const simulation_interfaces_srv_dds__ResetSimulation_Request_& request) {
  const std::uint8_t scopes = request.scope == 0 ? kResetAll : request.scope;
  Ask(ResetRequest(scopes), [caller](WorldServices& self, const ControlReply& reply) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__ResetSimulation_Response_ response{};
    response.result = MakeResult(reply, arena);
    self.reset_.Respond(caller, response);
  });
}

// std_srvs/Empty has no field for a failure.
void WorldServices::OnPlainReset(const RosCaller& caller, const std_srvs_srv_dds__Empty_Request_&) {
  Ask(ResetRequest(kResetAll), [caller](WorldServices& self, const ControlReply&) {
    std_srvs_srv_dds__Empty_Response_ response{};
    self.plain_reset_.Respond(caller, response);
  });
}

using ros::RosCaller;

struct WorldQueries::Search {
  RosCaller caller;
  std::vector<std::string> sources;
  std::size_t next = 0;  // of the sources
  bool continues = false;
  TagsFilter tags;
  std::vector<EntityReport> found;
};

void WorldQueries::Open(const ros::RosNode& node, const std::string& prefix) {
  get_world_.Open(node, prefix + "get_current_world", Bind(&WorldQueries::OnGetWorld));
  get_worlds_.Open(node, prefix + "get_available_worlds", Bind(&WorldQueries::OnGetWorlds));
  get_poses_.Open(node, prefix + "get_named_poses", Bind(&WorldQueries::OnGetPoses));
}

void WorldQueries::Close() {
  get_world_.Close();
  get_worlds_.Close();
  get_poses_.Close();
}

void WorldQueries::OnGetWorld(const RosCaller& caller, const simulation_interfaces_srv_dds__GetCurrentWorld_Request_&) {
  Ask(ControlCommand::kWorld, [caller](WorldQueries& self, const ControlReply& reply) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetCurrentWorld_Response_ response{};
    if (reply.entities.empty()) {
      response.result = MakeResult(kNoWorldLoaded, "no world is loaded", arena);
    } else {
      response.result = MakeResult(ResultCode::kOk, "", arena);
      response.world.name = arena.Copy(self.context().scene()->world().name);
      response.world.world_resource.uri = arena.Copy(reply.entities.front().type);
    }
    self.get_world_.Respond(caller, response);
  });
}

void WorldQueries::OnGetWorlds(const RosCaller& caller,
                               const simulation_interfaces_srv_dds__GetAvailableWorlds_Request_& request) {
  auto search = std::make_shared<Search>();
  search->caller = caller;
  search->sources = {""};
  for (const std::string& source : dds::Strings(request.additional_sources)) {
    search->sources.push_back(ResourcePath(source.c_str()));
  }
  search->continues = request.continue_on_error;
  search->tags = TagsFilter(request.filter);
  SearchNext(search);
}

void WorldQueries::SearchNext(const std::shared_ptr<Search>& search) {
  if (search->next == search->sources.size()) return Answer(*search, ResultCode::kOk, "");
  ControlRequest list;
  list.command = ControlCommand::kWorlds;
  list.source = search->sources[search->next++];
  Ask(list, [search](WorldQueries& self, const ControlReply& reply) {
    if (!reply.done && !search->continues) return self.Answer(*search, ResultCode::kOperationFailed, reply.problem);
    search->found.insert(search->found.end(), reply.entities.begin(), reply.entities.end());
    self.SearchNext(search);
  });
}

void WorldQueries::Answer(const Search& search, ResultCode code, const std::string& problem) {
  dds::WireArena arena;
  simulation_interfaces_srv_dds__GetAvailableWorlds_Response_ response{};
  response.result = MakeResult(code, problem, arena);
  // Files of worlds have no tags.
  if (code == ResultCode::kOk && search.tags.Matches({})) {
    auto* world = arena.Fill(response.worlds, search.found.size());
    for (const EntityReport& file : search.found) {
      world->name = arena.Copy(file.name);
      world->world_resource.uri = arena.Copy(file.type);
      ++world;
    }
  }
  get_worlds_.Respond(search.caller, response);
}

void WorldQueries::OnGetPoses(const RosCaller& caller,
                              const simulation_interfaces_srv_dds__GetNamedPoses_Request_& request) {
  const TagsFilter tags(request.tags);
  const std::shared_ptr<const Scene> scene = context().scene();
  std::vector<const NamedPlace*> places;
  for (const NamedPlace& place : scene->world().places) {
    if (tags.Matches(place.tags)) places.push_back(&place);
  }
  dds::WireArena arena;
  simulation_interfaces_srv_dds__GetNamedPoses_Response_ response{};
  response.result = MakeResult(ResultCode::kOk, "", arena);
  auto* pose = arena.Fill(response.poses, places.size());
  for (const NamedPlace* place : places) {
    pose->name = arena.Copy(place->name);
    pose->description = arena.Copy(place->description);
    arena.FillStrings(pose->tags, place->tags);
    pose->pose = ros::ToMessage(place->X_WN);
    ++pose;
  }
  get_poses_.Respond(caller, response);
}

}  // namespace troupe
