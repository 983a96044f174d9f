// Agents write the scans of their own robots; these make one file of them, the same whatever the packing.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"

namespace troupe {

// Merges files of JSON lines, each in the order of ticks, into `output`: by tick, and within a tick in the order of
// `parts`. A last line without its end, as a killed agent leaves, is left out; so is a part that does not exist, and
// what a robot that was started again measured twice. REQUIRES: parts are in the order of their robots.
Status MergeScans(const std::vector<std::string>& parts, const std::string& output);

}  // namespace troupe
