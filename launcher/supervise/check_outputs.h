// CheckOutputs: the output files of a run, before it begins.
#pragma once

#include "launcher/supervise/run_options.h"
#include "troupe/result.h"

namespace troupe {

// Fails if two outputs are one file, by whatever paths; if an output is a file that the run reads (its world or
// scenario, an included file, an image, a controller library); or if one cannot be written. Creates the files that do
// not exist, and changes no other.
Status CheckOutputs(const RunOptions& options);

}  // namespace troupe
