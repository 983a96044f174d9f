// LocalAddress: addresses of this host.
#pragma once

#include <string>

namespace troupe {

// The IPv4 address of a network interface by its name or its address; of the first one that is not a loopback interface
// for "auto". 127.0.0.1 if there is none.
std::string LocalAddress(const std::string& network_interface);

}  // namespace troupe
