#include "world-service/service/live_run.h"

#include <utility>

#include "common/base/identity.h"

namespace troupe {
namespace {

// More would make a line too long to read, which a log repeats for each lost agent.
constexpr std::size_t kNamesListed = 10;

}  // namespace

void AnnounceSession(const LiveRun& run) {
  SessionMessage session;
  session.run = run.options.run;
  session.protocol_version = kProtocolVersion;
  session.host = run.options.host;
  session.pid = run.options.pid;
  session.lease_seconds = run.options.lease_seconds;
  session.begun = run.started_at.has_value() || run.takes_over();
  session.incarnation = run.options.incarnation;
  session.world = WorldOf(run.scene);
  session.world_edition = run.frame.world_edition;
  if (run.options.scenes != nullptr) run.options.scenes->Add(run.scene);
  run.endpoint.SendSession(session);
}

FrameMessage SuccessorOf(const FrameMessage& frame) {
  FrameMessage next;
  next.run = frame.run;
  next.incarnation = frame.incarnation;
  next.edition = frame.edition;
  next.world_edition = frame.world_edition;
  next.fresh_edition = frame.fresh_edition;
  next.remembered = frame.remembered;
  return next;
}

AdmissionMessage MakeAdmission(const LiveRun& run, AgentId agent, bool admitted, std::string reason,
                               std::vector<std::string> taken) {
  return {run.options.run, agent, admitted, std::move(reason), std::move(taken), run.options.incarnation};
}

std::string ListNames(const WorldDescription& world, const std::vector<RobotId>& robots) {
  std::string list;
  for (std::size_t i = 0; i < robots.size() && i < kNamesListed; ++i) {
    list += (i == 0 ? "" : ", ") + world.robot(robots[i]).name;
  }
  if (robots.size() > kNamesListed) list += " and " + std::to_string(robots.size() - kNamesListed) + " more";
  return list;
}

}  // namespace troupe
