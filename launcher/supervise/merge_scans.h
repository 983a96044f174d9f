// MergeScans: one file of the scans of all agents, the same for every packing of robots into agents.
#pragma once

#include <string>
#include <vector>

#include "common/base/line_file.h"
#include "troupe/result.h"

namespace troupe {

// Merges files of JSON lines, each in the order of ticks, into `output`: by tick, and within a tick in the order of
// `parts`. Omitted are: a last line without its end, as left by a killed agent; a part that does not exist; and the
// second scan of a tick, as written by a restarted agent. With kFree the output fits even on a disk that the parts have
// filled. REQUIRES: parts are in the order of their robots.
Status MergeScans(const std::vector<std::string>& parts, const std::string& output, LineFile::Space space);

}  // namespace troupe
