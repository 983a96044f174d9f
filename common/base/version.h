// The version of the programs, and of the protocol between them.
#pragma once

#include <cstdint>

#include "troupe/version.h"

namespace troupe {

// Programs work together only when this is equal: it changes whenever a message or its meaning does.
inline constexpr std::uint32_t kProtocolVersion = 16;

}  // namespace troupe
