#include "robot-agent/agent/replica_task.h"

#include <fmt/format.h>

#include <new>
#include <string>
#include <utility>
#include <vector>

#include "common/base/version.h"
#include "robot-agent/robot/scan_log.h"

namespace troupe {

void ReplicaTask::Perform(const AgentOptions& options, const AgentResources& resources) {
  try {
    if (session) world_hash = Hash(session->world);
    if (history) {
      // The lines of the past are in the log, or in that of the agent before.
      if (resources.scan_log != nullptr) resources.scan_log->Mute(true);
      outcome = Retrace();
      if (resources.scan_log != nullptr) resources.scan_log->Mute(false);
      return;
    }
    outcome = is_new ? Make(options, resources) : Change();
  } catch (const std::bad_alloc& no_memory) {
    outcome = FailureOf(no_memory);
  }
}

Status ReplicaTask::Make(const AgentOptions& options, const AgentResources& resources) {
  replica.reset();
  if (session->protocol_version != kProtocolVersion) {
    return Failure(fmt::format("the world service on {} speaks protocol version {}, expected {}", session->host,
                               session->protocol_version, kProtocolVersion));
  }
  if (const Status status = Validate(session->world); !status.ok()) {
    return Failure(fmt::format("the world service on {} sent a bad world: {}", session->host, status.error().message));
  }
  std::vector<std::string> robots = options.robots;
  if (options.skip_deleted) {
    std::erase_if(robots, [this](const std::string& name) { return !FindRobot(session->world, name); });
    if (robots.empty()) return {};
  }
  Result<std::unique_ptr<Replica>> made =
      Replica::Create(std::move(session->world), robots, {resources.scan_log, options.libraries}, options.pool,
                      options.make_gateway, resources.trace, resources.find_map);
  if (!made.ok()) return made.error();
  replica = std::move(made).value();
  return {};
}

Status ReplicaTask::Change() {
  Status status;
  if (session) status = Validate(session->world);
  if (status.ok()) {
    status =
        session ? replica->ChangeWorld(std::move(session->world), fresh, fresh_edition) : replica->Renew(fresh_edition);
  }
  if (status.ok()) return status;
  return Failure("the world was edited, and this agent cannot continue: " + status.error().message);
}

Status ReplicaTask::Retrace() {
  for (HistoryEntry& entry : history->entries) {
    if (Status problem = Retrace(entry); !problem.ok()) {
      return Failure("the world service sent a bad history: " + problem.error().message);
    }
  }
  return {};
}

// As AgentProtocol answers the frames of a run.
Status ReplicaTask::Retrace(HistoryEntry& entry) {
  const FrameMessage& frame = entry.frame;
  // Robots without a memory may be of a later world, with other ids.
  const bool starts = !memory || !made_at || frame.fresh_edition > *made_at;
  if (frame.world_edition != world_edition) {
    if (!entry.world) return Error{{}, "a state without its world"};
    if (Status problem = Validate(*entry.world); !problem.ok()) return problem;
    if (frame.world_edition < world_edition) {
      put_aside = std::make_unique<SessionMessage>();
      put_aside->run = history->run;
      put_aside->world = replica->world();
      put_aside->world_edition = world_edition;
    }
    world_hash = Hash(*entry.world);
    if (Status problem = replica->ChangeWorld(std::move(*entry.world), starts, frame.fresh_edition); !problem.ok()) {
      return problem;
    }
    if (Status problem = replica->AddRobots(own_robots); !problem.ok()) return problem;
    world_edition = frame.world_edition;
  } else if (made_at && frame.fresh_edition > *made_at) {
    if (Status problem = replica->Renew(frame.fresh_edition); !problem.ok()) return problem;
  }
  if (Status problem = replica->CheckState(frame.state); !problem.ok()) return problem;
  if (memory && memory->edition != frame.edition) replica->Relocate(frame.state);
  if (entry.step_follows) {
    replica->Retrace(frame.state, frame.commands);
  } else {
    replica->Pause(frame.state);
  }
  made_at = frame.fresh_edition;
  memory = {frame.edition, frame.state.tick, entry.step_follows};
  return {};
}

}  // namespace troupe
