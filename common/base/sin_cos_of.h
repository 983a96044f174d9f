// Sines and cosines of many angles at a time.
//
// For rays: a scan of hundreds of directions spends most of its time on them otherwise. The bits are those of SinCos,
// so that a ray has the same direction whichever way it was made.
#pragma once

#include <span>

#include "common/base/instructions.h"
#include "troupe/deterministic_math.h"

namespace troupe {

// results[i] = SinCos(radians[i]), with the same bits, sixteen at a time by vector instructions.
// REQUIRES: results.size() == radians.size()
void SinCosOf(std::span<const double> radians, std::span<SinCosResult> results);

// SinCos for each of sixteen angles, none of which is above 1e5 either way.
using SinCosOfSixteen = void(const double* radians, double* sines, double* cosines);
// The variants that this processor can run, the quickest last.
std::span<const Variant<SinCosOfSixteen>> SinCosVariants();

}  // namespace troupe
