// SelectSession: the session of a tool whose command line names none.
#pragma once

#include "common/run/network_settings.h"
#include "troupe/result.h"

namespace troupe {

// For the discovery of a service by a tool.
inline constexpr double kDiscoverySeconds = 5.0;

// An empty session becomes the only one in the domain. The error: none was found in kDiscoverySeconds, or several.
Status SelectSession(NetworkSettings& network);

}  // namespace troupe
