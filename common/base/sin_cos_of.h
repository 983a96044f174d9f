// Sines and cosines of many angles at a time.
#pragma once

#include <span>

#include "troupe/deterministic_math.h"

namespace troupe {

// results[i] = SinCos(radians[i]), with the same bits, sixteen at a time by vector instructions.
// REQUIRES: results.size() == radians.size()
void SinCosOf(std::span<const double> radians, std::span<SinCosResult> results);

}  // namespace troupe
