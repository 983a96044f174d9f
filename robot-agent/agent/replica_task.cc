#include "robot-agent/agent/replica_task.h"

#include <fmt/format.h>

#include <new>
#include <utility>

#include "common/base/identity.h"
#include "common/model/find_robots.h"
#include "robot-agent/robot/robot.h"

namespace troupe {
namespace {

// That of the service, in this process or in memory that it shares with this machine; or else one of this agent, made
// of a validated world.
Result<PreparedWorld> Prepare(Shared<WorldDescription> world, const AgentResources& resources) {
  if (resources.find_world) {
    if (std::optional<PreparedWorld> prepared = resources.find_world(*world)) return *std::move(prepared);
  }
  const std::uint64_t hash = Hash(*world);
  if (resources.scenes != nullptr) {
    if (std::shared_ptr<const Scene> scene = resources.scenes->Find(world))
      return PreparedWorld{std::move(scene), hash};
  }
  if (const Status status = Validate(world); !status.ok()) return status.error();
  return PreparedWorld{std::make_shared<const Scene>(std::move(world)), hash};
}

}  // namespace

void ReplicaTask::Perform(const AgentOptions& options, const AgentResources& resources) {
  try {
    if (auto* const making = std::get_if<Making>(&work)) {
      outcome = Make(*making->session, options, resources);
    } else if (auto* const change = std::get_if<Changing>(&work)) {
      outcome = Change(*change, resources);
    } else if (const auto* const left = std::get_if<Leaving>(&work)) {
      std::erase_if(robots.names, [&](const std::string& name) { return left->robots.contains(name); });
      outcome = robots.replica->RemoveRobots(left->robots);
    } else {
      // The lines of the past are in the log already, or in the log of the previous agent.
      if (resources.scan_log != nullptr) resources.scan_log->Mute(true);
      outcome = Retrace(std::get<Retracing>(work), resources);
      if (resources.scan_log != nullptr) resources.scan_log->Mute(false);
    }
  } catch (const std::bad_alloc& no_memory) {
    outcome = FailureOf(no_memory);
  }
}

Status ReplicaTask::Make(const SessionMessage& session, const AgentOptions& options, const AgentResources& resources) {
  robots = {};
  if (session.protocol_version != kProtocolVersion) {
    return Failure(fmt::format("the world service on {} speaks protocol version {}, expected {}", session.host,
                               session.protocol_version, kProtocolVersion));
  }
  Result<PreparedWorld> prepared = Prepare(session.world, resources);
  if (!prepared.ok()) {
    return Failure(fmt::format("the world service on {} sent a bad world: {}", session.host, prepared.error().message));
  }
  std::vector<std::string> names = options.robots;
  if (options.skip_unavailable) {
    names = NamesThatExist(session.world, names);
    if (names.empty()) return {};
  }
  robots.world_hash = prepared.value().world_hash;
  robots.world_edition = session.world_edition;
  Result<std::unique_ptr<Replica>> made =
      Replica::Create(std::move(prepared).value().scene, names, {resources.scan_log, options.libraries}, options.pool,
                      options.make_gateway, resources.trace);
  if (!made.ok()) return made.error();
  robots.replica = std::move(made).value();
  robots.names = robots.replica->RobotNames();
  return {};
}

Status ReplicaTask::Change(const Changing& change, const AgentResources& resources) {
  Status status;
  if (change.session) {
    Result<PreparedWorld> prepared = Prepare(change.session->world, resources);
    if (prepared.ok()) {
      robots.world_hash = prepared.value().world_hash;
      robots.world_edition = change.session->world_edition;
      status = robots.replica->ChangeWorld(std::move(prepared).value().scene, change.fresh, change.fresh_edition);
    } else {
      status = prepared.error();
    }
  } else {
    status = robots.replica->Renew(change.fresh_edition);
  }
  // A history may have ended in a world without some of the robots: one that was spawned in the newest state.
  // Robots are known by name here: ids may be others in another world.
  if (status.ok() && change.session) status = robots.replica->AddRobots(robots.names);
  if (!status.ok()) {
    return Failure("the world was edited, and this agent cannot continue: " + status.error().message);
  }
  robots.names = robots.replica->RobotNames();
  if (change.fresh) {
    robots.fresh_edition = change.fresh_edition;
    robots.memory.reset();
    robots.log_is_marked = true;  // by the change
  }
  return {};
}

Status ReplicaTask::Retrace(Retracing& past, const AgentResources& resources) {
  for (HistoryEntry& entry : past.history->entries) {
    if (Status problem = Retrace(entry, past, resources); !problem.ok()) {
      return Failure("the world service sent a bad history: " + problem.error().message);
    }
  }
  return {};
}

// As AgentProtocol answers the frames of a run.
Status ReplicaTask::Retrace(HistoryEntry& entry, Retracing& past, const AgentResources& resources) {
  const FrameMessage& frame = entry.frame;
  Replica& replica = *robots.replica;
  // Robots without a memory may be of a later world, with other ids.
  const bool starts = !robots.memory || !robots.fresh_edition || frame.fresh_edition > *robots.fresh_edition;
  if (frame.world_edition != robots.world_edition) {
    if (!entry.world) return Error{{}, "a state without its world"};
    Result<PreparedWorld> prepared = Prepare(std::move(*entry.world), resources);
    if (!prepared.ok()) return prepared.error();
    if (frame.world_edition < robots.world_edition) {
      past.later_world = std::make_unique<SessionMessage>();
      past.later_world->run = past.history->run;
      past.later_world->world = WorldOf(replica.scene());
      if (resources.scenes != nullptr) resources.scenes->Add(replica.scene());
      past.later_world->world_edition = robots.world_edition;
    }
    robots.world_hash = prepared.value().world_hash;
    Status changed = replica.ChangeWorld(std::move(prepared).value().scene, starts, frame.fresh_edition);
    if (!changed.ok()) return changed;
    if (Status problem = replica.AddRobots(robots.names); !problem.ok()) return problem;
    robots.world_edition = frame.world_edition;
  } else if (robots.fresh_edition && frame.fresh_edition > *robots.fresh_edition) {
    if (Status problem = replica.Renew(frame.fresh_edition); !problem.ok()) return problem;
  }
  if (Status problem = replica.CheckState(frame.state); !problem.ok()) return problem;
  if (robots.memory && robots.memory->edition != frame.edition) replica.Relocate(frame.state);
  if (entry.step_follows) {
    replica.Retrace(frame.state, frame.commands);
  } else {
    replica.Pause(frame.state);
  }
  robots.fresh_edition = frame.fresh_edition;
  robots.memory = {frame.edition, frame.state.tick, entry.step_follows};
  return {};
}

}  // namespace troupe
