#include "robot-agent/agent/replica_task.h"

#include <fmt/format.h>

#include <new>
#include <string>
#include <utility>
#include <vector>

#include "common/base/version.h"

namespace troupe {

void ReplicaTask::Perform(const AgentOptions& options, const AgentOutputs& outputs) {
  try {
    if (session) world_hash = Hash(session->world);
    outcome = is_new ? Make(options, outputs) : Change();
  } catch (const std::bad_alloc& no_memory) {
    outcome = FailureOf(no_memory);
  }
}

Status ReplicaTask::Make(const AgentOptions& options, const AgentOutputs& outputs) {
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
    if (robots.empty()) robots = options.robots;  // the error names the first one
  }
  Result<std::unique_ptr<Replica>> made =
      Replica::Create(std::move(session->world), robots, {outputs.scan_log, options.libraries}, options.threads,
                      options.make_gateway, outputs.trace);
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

}  // namespace troupe
