// Names and texts that several programs print: of agents, and of the robots that a run waits for.
//
// Pure functions. Agents are named by their robots, so that a restarted agent of the same robots has the same name,
// keys and partition.
#pragma once

#include <string>
#include <vector>

#include "transport/protocol/messages.h"

namespace troupe {

// AgentName: the name of an agent in its keys and in the partition of its messages.
// 16 digits of [0-9a-f] that depend on the names of its robots, not on their order.
std::string AgentName(const std::vector<std::string>& robots);

// WaitingText: the robots that a run waits for, for reports on a terminal.
// "r3, r4 (1.2 s)": up to four names, the number of the others, and the time of waiting. Empty: the run waits for none.
std::string WaitingText(const StatusMessage& status);

}  // namespace troupe
