// PlaceRobots: assigns the robots of a run to its hosts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/run/host_settings.h"
#include "troupe/result.h"

namespace troupe {

// The index of the host of each robot: first the robots that a host names; then, in order, the number of robots that a
// host requests; the others in equal shares on the hosts that do neither. An error if a host names an unknown robot, or
// if robots are left without a host.
Result<std::vector<std::size_t>> PlaceRobots(const std::vector<std::string>& robots,
                                             const std::vector<HostSettings>& hosts);

}  // namespace troupe
