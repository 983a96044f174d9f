// The name of this machine.
#pragma once

#include <string>

namespace troupe {

// As the system says; "localhost" if it does not.
std::string HostName();

}  // namespace troupe
