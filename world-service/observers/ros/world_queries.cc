#include "world-service/observers/ros/world_queries.h"

#include <utility>

#include "ros/messages/convert.h"
#include "world-service/observers/ros/resource_path.h"
#include "world-service/observers/ros/tags_filter.h"

namespace troupe {

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
