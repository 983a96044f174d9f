// The name of this machine.
#pragma once

#include <string>

namespace troupe {

// The system's host name; "localhost" if it has none.
std::string HostName();

}  // namespace troupe
