#include "world-service/service/world_editor.h"

#include <algorithm>
#include <filesystem>
#include <new>
#include <set>
#include <utility>

#include "world-service/service/apply_edit.h"
#include "world-service/service/event_log.h"

namespace troupe {
namespace {

// The name of the entity that a request spawns.
std::string SpawnName(const WorldDescription& world, const control::Spawn& spawn) {
  if (spawn.name.empty()) return FreeName(world, NameOfSource(spawn.source));
  return spawn.rename ? FreeName(world, spawn.name) : spawn.name;
}

// A line for users about a request that has an effect.
struct Notice {
  template <typename Request>
  std::string operator()(const Request&) const {
    return "";
  }
  std::string operator()(const control::Reset&) const { return "the world is reset"; }
  std::string operator()(const control::LoadWorld& load) const {
    return load.source.empty() ? "the world is unloaded" : "the world is replaced by " + load.source;
  }
  std::string operator()(const control::Spawn& spawn) const { return "'" + spawn.name + "' is spawned"; }
  std::string operator()(const control::Delete& removal) const { return "'" + removal.name + "' is deleted"; }
  std::string operator()(const control::Rewind& rewind) const {
    return "the run is rewound to tick " + std::to_string(rewind.tick);
  }
  std::string operator()(const control::SetPose& move) const { return "the pose of '" + move.name + "' is set"; }
  std::string operator()(const control::SetTwist& turn) const { return "the twist of '" + turn.name + "' is set"; }
  std::string operator()(const control::Door& door) const {
    return "door '" + door.name + (door.opening > 0.0 ? "' is to open" : "' is to close");
  }
  std::string operator()(const control::Lift& call) const {
    return "lift '" + call.name + "' is called to '" + call.floor + "'";
  }
  std::string operator()(const control::Light& light) const {
    return "light '" + light.name + (light.on ? "' is switched on" : "' is switched off");
  }
  std::string operator()(const control::Lane& lane) const {
    const char* const rule = lane.speed_limit == 0.0 ? "is closed" : lane.speed_limit < 0.0 ? "is open" : "has a limit";
    return "lane '" + lane.from + " - " + lane.to + "' " + rule;
  }
  std::string operator()(const control::Zone& zone) const {
    return "zone '" + zone.name + (zone.on ? "' is switched on" : "' is switched off");
  }
};

}  // namespace

WorldEditor::WorldEditor(LiveRun& run, TickEngine& engine) : run_(run), engine_(engine), original_(run.scene) {
  if (!run.continues()) return;
  const ResumedRun& resumed = *run.options.resumed;
  original_ = resumed.original;
  deleted_ = resumed.deleted;
  run_.newcomers = resumed.progress.newcomers;
  newcomers_since_ = run.created_at;
  for (const RobotId robot : run_.newcomers) new_robots_.push_back(run_.world().robot(robot).name);
}

Result<control::Request> WorldEditor::Apply(control::Request request, const RequestedWorld& requested, double now) {
  auto* const spawn = std::get_if<control::Spawn>(&request);
  const WorldDescription* world = requested.world.get();
  std::optional<WorldDescription> with_domain;
  if (spawn != nullptr) {
    spawn->name = SpawnName(run_.world(), *spawn);
    // The spawned robot has a domain as robots of a spawn rule have.
    const bool needs_domain = requested.ros_domains_from && world != nullptr && world->robots.size() == 1 &&
                              !world->robots.front().ros.domain;
    if (needs_domain) {
      Result<WorldDescription> chosen = WithRosDomain(*requested.ros_domains_from, *world);
      if (!chosen.ok()) return chosen.error();
      with_domain = std::move(chosen).value();
      world = &*with_domain;
    }
  }
  // The description of the deleted entity goes with the edit to the recording, from which a restore can be replayed.
  std::optional<DeletedEntity> deleted;
  if (const auto* const removal = std::get_if<control::Delete>(&request)) {
    const Result<ModelId> root = FindEntity(run_.world(), removal->name);
    if (!root.ok()) return root.error();
    deleted = {removal->name, nullptr};
    if (!run_.scene->person_of(root.value())) {
      deleted->entity = std::make_shared<const WorldDescription>(ExtractEntity(run_.world(), root.value()));
    }
  }
  const AppliedEdit edit{request, deleted ? deleted->entity.get() : world};
  Result<EditedWorld> edited = ApplyIfRoom(edit);
  if (!edited.ok()) return edited.error();
  // Only edits that bring entities can violate the owner's conditions.
  if (world != nullptr) {
    if (const Status allowed = CheckWorld(edited.value().scene->world()); !allowed.ok()) return allowed.error();
  }
  if (spawn != nullptr) {
    if (const Status able = CheckSpawned(edited.value().scene->world(), spawn->name); !able.ok()) return able.error();
  }
  if (deleted) {
    deleted_.push_back(std::move(*deleted));
    // A tool may spawn and delete without end: the oldest deletion can no longer be restored.
    if (deleted_.size() > kMaxDeleted) deleted_.pop_front();
  }
  ReportRequest(request);
  if (control::Is<control::LoadWorld>(request)) original_ = edited.value().scene;
  Commit(std::move(edited).value(), edit, now);
  return request;
}

void WorldEditor::ReportRequest(const control::Request& request) {
  run_.notices.AddFromPeer("tick " + std::to_string(run_.frame.state.tick) + ": " + std::visit(Notice(), request));
}

// The world has what its controller needs.
Status WorldEditor::CheckSpawned(const WorldDescription& world, const std::string& name) const {
  const std::optional<RobotId> robot = FindRobot(world, name);
  const auto& check = run_.options.check_in_world;
  return robot && check ? check(world, {&*robot, 1}) : Status();
}

Status WorldEditor::CheckWorld(const WorldDescription& world) const {
  return run_.options.check_world ? run_.options.check_world(world) : Status();
}

Result<WorldDescription> WorldEditor::WithRosDomain(std::uint32_t first, const WorldDescription& spawned) const {
  std::set<std::uint32_t> used;
  for (std::size_t i = 0; i < run_.world().robots.size(); ++i) {
    const std::optional<std::uint32_t> domain = run_.world().robots[i].ros.domain;
    if (domain && RobotExists(run_.world(), RobotId(i))) used.insert(*domain);
  }
  WorldDescription with = spawned;
  for (std::uint32_t domain = first; domain <= kMaxRosDomain; ++domain) {
    with.robots.front().ros.domain = domain;
    // Free among the robots, and none that the run itself uses for its own traffic.
    if (!used.contains(domain) && CheckWorld(with).ok()) return with;
  }
  return Error{{},
               "found no free ROS domain from " + std::to_string(first) + " to " + std::to_string(kMaxRosDomain) +
                   ", expected one for the robot, as for those of its spawn rule"};
}

Result<std::shared_ptr<const WorldDescription>> WorldEditor::Deleted(const std::string& name) const {
  const auto found = std::find_if(deleted_.rbegin(), deleted_.rend(),
                                  [&](const DeletedEntity& deleted) { return deleted.name == name; });
  if (found == deleted_.rend()) return BadInput("no entity '" + name + "' was deleted");
  if (found->entity == nullptr) return BadInput("'" + name + "' is a person, whom a reset of the run restores");
  return found->entity;
}

Result<EditedWorld> WorldEditor::ApplyIfRoom(const AppliedEdit& edit) const {
  try {
    return ApplyEdit(edit, original_, run_.scene, run_.frame.state);
  } catch (const std::bad_alloc& no_memory) {  // nothing has changed yet
    return FailureOf(no_memory);
  }
}

void WorldEditor::RevokeSpawn(const std::string& name, double now) {
  const control::Request removal = control::Delete{name};
  const AppliedEdit edit{removal};
  Result<EditedWorld> without = ApplyEdit(edit, original_, run_.scene, run_.frame.state);
  if (without.ok()) Commit(std::move(without).value(), edit, now);
}

void WorldEditor::Commit(EditedWorld edited, const AppliedEdit& edit, double now) {
  FrameMessage next = SuccessorOf(run_.frame);
  ++next.edition;
  if (edited.fresh) {
    next.fresh_edition = next.edition;
    run_.memories.OnFreshStart(next.edition);
    run_.restoring = next.remembered = false;
  }
  run_.memories.OnEdit(next, run_.frame.state.tick);
  if (edited.scene != run_.scene) {
    next.world_edition = next.edition;
    ChangeWorld(std::move(edited.scene), edited.fresh, next);
  }
  next.state = std::move(edited.state);
  next.events = std::move(edited.events);
  Publish(std::move(next), edit, now);
}

void WorldEditor::Publish(FrameMessage next, const AppliedEdit& edit, double now, bool is_recorded) {
  newcomers_since_ = now;
  engine_.PublishEdit(std::move(next), edit, now, is_recorded);
  previous_scene_.reset();
}

void WorldEditor::Rewind(const control::Request& request, const RewoundRun& rewound, double now) {
  ReportRequest(request);
  original_ = rewound.original;
  FrameMessage next = SuccessorOf(run_.frame);
  next.edition = rewound.frame.edition;
  next.world_edition = rewound.frame.world_edition;
  next.fresh_edition = rewound.frame.fresh_edition;
  next.state = rewound.frame.state;
  run_.memories.OnFreshStart(next.fresh_edition);
  run_.memories.OnRewind(rewound.previous);
  run_.restoring = next.remembered = rewound.previous.has_value();
  ChangeWorld(rewound.scene, true, next);
  Publish(std::move(next), AppliedEdit{request}, now, true);
}

void WorldEditor::ChangeWorld(std::shared_ptr<const Scene> scene, bool fresh, const FrameMessage& next) {
  if (fresh) {
    // Ids of events mean other things from now on.
    for (const Event& event : run_.events.DrainUnreported()) run_.notices.Add(EventText(run_.world(), event));
    run_.events.DiscardPending();
    run_.vehicle_states.Clear();
  }
  // Until Publish, engine, members and observers may still refer to the scene before; an exception between must not
  // leave them with a dangling one.
  previous_scene_ = std::exchange(run_.scene, std::move(scene));
  const WorldDescription& world = run_.world();
  Membership::WorldChange change = run_.members.ChangeWorld(world, next.world_edition, fresh);
  engine_.ChangeWorld(change.gone);
  std::vector<std::string> newcomers;
  for (const RobotId robot : change.newcomers) newcomers.push_back(world.robot(robot).name);
  // In a fresh edition all robots begin at the same edition, so none of them is an exception.
  if (!fresh) run_.memories.OnNewRobots(newcomers, next.edition);
  new_robots_.insert(new_robots_.end(), newcomers.begin(), newcomers.end());
  run_.newcomers = std::move(change.newcomers);
  for (RunObserver* observer : run_.observers) observer->OnWorldChange(run_.scene, next.edition);
}

void WorldEditor::OnJoined(const std::vector<RobotId>& robots) {
  for (const RobotId robot : robots) std::erase(run_.newcomers, robot);
}

Status WorldEditor::CheckTimeout(double now) {
  const double timeout = run_.options.start_timeout_seconds;
  if (run_.newcomers.empty() || timeout <= 0.0 || now - newcomers_since_ < timeout) return Status();
  const std::string problem = "no agent joined for " + ListNames(run_.world(), std::exchange(run_.newcomers, {})) +
                              " within " + std::to_string(static_cast<int>(timeout)) + " s";
  run_.notices.Add(problem);
  return Failure(problem);
}

std::vector<std::string> WorldEditor::DrainNewRobots() {
  return std::exchange(new_robots_, {});
}

}  // namespace troupe
