// ViewerProcess: the viewer of a run over DDS: `troupe view` as a process of its own, on the launcher's host.
//
// A process and not a thread of the launcher, so that a browser's requests and pictures cannot delay the supervision,
// and a fault of the viewer cannot end the run. A run without its viewer is the same run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/supervise/run_keys.h"
#include "launcher/supervise/run_options.h"
#include "troupe/result.h"

namespace troupe {

class ViewerProcess {
 public:
  // `service_address` is "host:port", `journal` its options for that. The error is for users; without a viewer the run
  // is the same.
  Status Start(Host& host, const RunOptions& options, const std::string& service_address, const RunKeys& keys,
               const std::vector<std::string>& journal);

  // Checks for its end. The error, once, is an end that was not asked for.
  Status Poll();
  bool running() const { return process_ && process_->running(); }
  // Asks it to end. No effect without a viewer, as below.
  void Stop();
  void Kill();

 private:
  std::unique_ptr<Child> process_;  // null: none
  bool stopped_ = false;
};

}  // namespace troupe
