// The services about the whole world: those that load and reset it, and those that report it, its named poses and the
// worlds that can be loaded.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ros/messages/convert.h"
#include "world-service/observers/ros/request_values.h"
#include "world-service/observers/ros/simulation_context.h"

namespace troupe {
namespace {

TROUPE_SIMULATION_SERVICE(LoadWorld);
TROUPE_SIMULATION_SERVICE(UnloadWorld);
TROUPE_SIMULATION_SERVICE(ResetSimulation);
TROUPE_SIMULATION_SERVICE(GetCurrentWorld);
TROUPE_SIMULATION_SERVICE(GetAvailableWorlds);
TROUPE_SIMULATION_SERVICE(GetNamedPoses);
using PlainResetRequest = std_srvs_srv_dds__Empty_Request_;
using PlainResetResponse = std_srvs_srv_dds__Empty_Response_;

// Results of LoadWorld.
constexpr std::uint8_t kUnsupportedWorldFormat = 101;
constexpr std::uint8_t kNoWorldResource = 102;
constexpr std::uint8_t kMalformedWorld = 103;

std::uint8_t LoadCode(const ControlReply& reply, const std::string& path) {
  if (reply.done) return static_cast<std::uint8_t>(ResultCode::kOk);
  if (!path.empty() && HasOtherFormat(path, {".world", ".json", ".yaml", ".yml"})) return kUnsupportedWorldFormat;
  if (reply.problem_code == ErrorCode::kMalformed) return kMalformedWorld;
  return static_cast<std::uint8_t>(ResultCode::kOperationFailed);
}

void OnLoadWorld(SimulationContext& context, const LoadWorldCall& call, const LoadWorldRequest& request) {
  control::LoadWorld load;
  load.source = ResourcePath(request.uri);
  if (load.source.empty()) {
    load.text = dds::Text(request.resource_string);
    if (load.text.empty()) return call.Answer(kNoWorldResource, "found no uri, expected a file");
    if (IsOtherText(load.text)) {
      return call.Answer(kUnsupportedWorldFormat, "found a text of XML, expected a Stage world or a scenario");
    }
  }
  context.Ask(load, [call, path = load.source](SimulationContext& self, const ControlReply& reply) {
    dds::WireArena arena;
    LoadWorldResponse response{};
    response.result = MakeResult(LoadCode(reply, path), reply.problem, arena);
    response.world.name = arena.Copy(reply.done ? self.scene()->world().name : "");
    response.world.world_resource.uri = arena.Copy(path);
    call.Respond(response);
  });
}

void OnUnloadWorld(SimulationContext& context, const UnloadWorldCall& call, const UnloadWorldRequest&) {
  if (!context.has_world()) return call.Answer(kNoWorldLoaded, "no world is loaded");
  context.Ask(control::LoadWorld(), [call](SimulationContext&, const ControlReply& reply) { call.Answer(reply); });
}

void OnResetSimulation(SimulationContext& context, const ResetSimulationCall& call,
                       const ResetSimulationRequest& request) {
  if (context.is_stepping()) return call.Answer(ResultCode::kOperationFailed, kIsStepping);
  context.Ask(control::Reset{request.scope == 0 ? kResetAll : request.scope},
              [call](SimulationContext&, const ControlReply& reply) { call.Answer(reply); });
}

// std_srvs/Empty has no field for a failure.
void OnPlainReset(SimulationContext& context, const Call<PlainResetRequest, PlainResetResponse>& call,
                  const PlainResetRequest&) {
  context.Ask(control::Reset(), [call](SimulationContext&, const ControlReply&) {
    PlainResetResponse response{};
    call.Respond(response);
  });
}

void OnGetCurrentWorld(SimulationContext& context, const GetCurrentWorldCall& call, const GetCurrentWorldRequest&) {
  context.Ask(control::World(), [call](SimulationContext& self, const ControlReply& reply) {
    if (reply.entities.empty()) return call.Answer(kNoWorldLoaded, "no world is loaded");
    dds::WireArena arena;
    GetCurrentWorldResponse response{};
    response.result = MakeResult(ResultCode::kOk, "", arena);
    response.world.name = arena.Copy(self.scene()->world().name);
    response.world.world_resource.uri = arena.Copy(reply.entities.front().type);
    call.Respond(response);
  });
}

// The worlds in several folders, one after another.
struct Search {
  GetAvailableWorldsCall call;
  std::vector<std::string> sources;
  bool continues = false;
  TagsFilter tags;
  std::size_t next = 0;  // of the sources
  std::vector<EntityReport> found = {};
};

void AnswerSearch(const Search& search) {
  dds::WireArena arena;
  GetAvailableWorldsResponse response{};
  response.result = MakeResult(ResultCode::kOk, "", arena);
  if (search.tags.Matches({})) {  // files of worlds have no tags
    auto* world = arena.Fill(response.worlds, search.found.size());
    for (const EntityReport& file : search.found) {
      world->name = arena.Copy(file.name);
      world->world_resource.uri = arena.Copy(file.type);
      ++world;
    }
  }
  search.call.Respond(response);
}

void SearchNext(SimulationContext& context, const std::shared_ptr<Search>& search) {
  if (search->next == search->sources.size()) return AnswerSearch(*search);
  context.Ask(control::Worlds{search->sources[search->next++]},
              [search](SimulationContext& self, const ControlReply& reply) {
                if (!reply.done && !search->continues) return search->call.Answer(reply);
                search->found.insert(search->found.end(), reply.entities.begin(), reply.entities.end());
                SearchNext(self, search);
              });
}

void OnGetAvailableWorlds(SimulationContext& context, const GetAvailableWorldsCall& call,
                          const GetAvailableWorldsRequest& request) {
  const auto search =
      std::make_shared<Search>(Search{call, {""}, request.continue_on_error, TagsFilter(request.filter)});
  for (const std::string& source : dds::Strings(request.additional_sources)) {
    search->sources.push_back(ResourcePath(source.c_str()));
  }
  SearchNext(context, search);
}

void OnGetNamedPoses(SimulationContext& context, const GetNamedPosesCall& call, const GetNamedPosesRequest& request) {
  const TagsFilter tags(request.tags);
  const std::shared_ptr<const Scene> scene = context.scene();
  std::vector<const NamedPlace*> places;
  for (const NamedPlace& place : scene->world().places) {
    if (tags.Matches(place.tags)) places.push_back(&place);
  }
  dds::WireArena arena;
  GetNamedPosesResponse response{};
  response.result = MakeResult(ResultCode::kOk, "", arena);
  auto* pose = arena.Fill(response.poses, places.size());
  for (const NamedPlace* place : places) {
    pose->name = arena.Copy(place->name);
    pose->description = arena.Copy(place->description);
    arena.FillStrings(pose->tags, place->tags);
    pose->pose = ros::ToMessage(place->X_WN);
    ++pose;
  }
  call.Respond(response);
}

}  // namespace

void AddWorldServices(ServiceSet& services) {
  services.Add("load_world", &OnLoadWorld);
  services.Add("unload_world", &OnUnloadWorld);
  services.Add("reset_simulation", &OnResetSimulation);
  services.Add("/reset", &OnPlainReset);
  services.Add("get_current_world", &OnGetCurrentWorld);
  services.Add("get_available_worlds", &OnGetAvailableWorlds);
  services.Add("get_named_poses", &OnGetNamedPoses);
}

}  // namespace troupe
