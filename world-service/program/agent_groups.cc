#include "world-service/program/agent_groups.h"

#include <algorithm>

namespace troupe {
namespace {

// docs/performance.md has the trials. A group costs the service a participant with its threads.
constexpr std::size_t kAgentsOfGroup = 64;
constexpr std::size_t kMostGroups = 32;

}  // namespace

std::size_t CountAgentGroups(const ServiceCommandLine& line, const LoadedWorld& loaded, bool secured) {
  const NetworkSettings& network = line.network;
  const bool is_shared = network.data_sharing && network.network_interface == kLoopbackInterface &&
                         network.network_profile.empty() && !secured;
  if (!is_shared || !line.report_fd) return 1;
  const std::size_t agents = loaded.world.robots.size() / std::max(1U, loaded.settings.robots_per_process);
  const std::size_t wanted = (agents + kAgentsOfGroup - 1) / kAgentsOfGroup;
  return std::clamp(wanted, std::max(std::size_t{1}, line.ports.size()), std::max(kMostGroups, line.ports.size()));
}

}  // namespace troupe
