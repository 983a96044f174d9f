// DDS Security for a participant: Cyclone's three plugins, and the participant's keys.
#pragma once

#include <string>

#include "transport/dds/binding/qos.h"

namespace troupe::dds {

// `enclave`: a folder as in common/base/enclave.h, whose files are not looked at.
Qos WithSecurity(Qos participant, const std::string& enclave);

}  // namespace troupe::dds
