// The version of the step: a recording can be stepped again only by programs with the same one.
#pragma once

#include <cstdint>

namespace troupe {

// Changes with every change of Step or of an edit that gives another result for the same input, as the golden hashes
// do.
inline constexpr std::uint32_t kStepVersion = 4;

}  // namespace troupe
