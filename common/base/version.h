// The version of the programs, and of the protocol that they speak with each other.
#pragma once

#include <cstdint>

namespace troupe {

// "0.1.0"
const char* VersionText();

// Programs work together only when this is equal: it changes whenever a message or its meaning does.
inline constexpr std::uint32_t kProtocolVersion = 7;

}  // namespace troupe
