// Which robot runs on which host.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/worldfile/host_settings.h"

namespace troupe {

// For each robot the index of its host: first those that a host names, then those that it counts, in order, and the
// rest in equal shares for the hosts that say neither. An error if a host names a robot that is not there, or if robots
// are left without a host.
Result<std::vector<std::size_t>> PlaceRobots(const std::vector<std::string>& robots,
                                             const std::vector<HostSettings>& hosts);

}  // namespace troupe
