// AgentName: the name of an agent in its keys and in the partition of its messages.
#pragma once

#include <string>
#include <vector>

namespace troupe {

// 16 digits of [0-9a-f] that depend on the names of its robots, not on their order.
std::string AgentName(const std::vector<std::string>& robots);

}  // namespace troupe
