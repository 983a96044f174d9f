// The table of `troupe top`.
#pragma once

#include <string>
#include <vector>

#include "transport/dds/tools/session_monitor.h"

namespace troupe {

// A heading and a line for each session, columns aligned.
std::string SessionTable(const std::vector<SessionInfo>& sessions);

}  // namespace troupe
