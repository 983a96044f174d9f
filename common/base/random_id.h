// Unique ids of processes and clients. Not for the simulation: they differ from run to run.
#pragma once

#include <cstdint>

namespace troupe {

// 64 bits from the machine's source of randomness.
std::uint64_t MakeRandomId();

}  // namespace troupe
