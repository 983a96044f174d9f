// InProcessBridge: the ros-service-bridge of a run in one process: a child of that process all the same, because it is
// on another DDS implementation.
#pragma once

#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/process/signal_watch.h"
#include "launcher/supervise/bridge_process.h"

namespace troupe {

class InProcessBridge {
 public:
  // As BridgeProcess::Start. Without a bridge the run is the same.
  void Start(const RunOptions& options);

  // Readable when Process has something to do; empty without a bridge.
  std::vector<int> descriptors() const;
  // The time for which to wait for them, in ms; -1: without end.
  int WaitMilliseconds() const;
  // Prints its lines, and starts it again when it has died.
  void Process();
  // Ends it; kills it if it does not end within seconds. `signals` tells of the ends of children.
  void Stop(SignalWatch& signals);

 private:
  void PrintOutput();

  LocalHost host_;
  BridgeProcess bridge_;
  bool on_ = false;
};

}  // namespace troupe
