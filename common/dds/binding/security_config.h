// DDS Security in Cyclone's configuration: its three plugins, and the keys of a participant.
#pragma once

#include <string>

namespace troupe::dds {

// The element <Security>. Empty for an empty `enclave` (common/base/enclave.h), whose files are not looked at.
std::string SecurityXml(const std::string& enclave);

}  // namespace troupe::dds
