// Whether a participant could have an index on this machine: Cyclone takes its ports, and does not tell which are
// taken.
#pragma once

#include <cstdint>

namespace troupe::dds {

// The discovery port of a participant with this index, and the one after it, for data, are free now. True as well if no
// socket can be made: DDS reports the cause.
bool PortsAreFree(std::uint32_t domain, std::uint32_t participant_index);

}  // namespace troupe::dds
