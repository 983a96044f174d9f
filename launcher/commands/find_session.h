// FindSession: the session of a tool whose command line names none.
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/run/network_settings.h"

namespace troupe {

// For the discovery of a service by a tool.
inline constexpr double kDiscoverySeconds = 5.0;

// The name of the only session in the domain. The error: none was found in kDiscoverySeconds, or several.
Result<std::string> FindSession(const NetworkSettings& network);

}  // namespace troupe
