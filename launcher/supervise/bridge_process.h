// BridgeProcess: the program ros-service-bridge of a run with ROS 2, on the launcher's host.
#pragma once

#include "launcher/supervise/run_options.h"
#include "launcher/supervise/supervised_process.h"

namespace troupe {

// Whether the program is installed beside this one.
bool HasServiceBridge();

// Chooses the programs whose service calls are answered, unless the options do. The error is a choice that needs a
// bridge where it is not installed.
Status ChooseServiceClients(RunOptions& options);

class BridgeProcess : public SupervisedProcess {
 public:
  BridgeProcess();

  // No effect where the options need no bridge. The host must outlive this. The error is for people.
  Status Start(Host& host, const RunOptions& options);
};

}  // namespace troupe
