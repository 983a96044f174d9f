// CheckRosOptions: whether ROS's environment is valid, and the participants of a run have their keys for ROS 2, before
// any process is started.
#pragma once

#include "launcher/supervise/run_options.h"
#include "troupe/result.h"

namespace troupe {

// Fails for clients of services that this build cannot answer, for a run with ROS whose environment is not valid, and
// with the first enclave whose keys are required and missing; prints a warning where ROS itself would continue, and a
// warning for each that a run in one process does without. Looks at the keystore of this host only, so not for the
// processes of remote hosts, which look themselves. Other faults of the file are left to the run.
Status CheckRosOptions(const RunOptions& options);

}  // namespace troupe
