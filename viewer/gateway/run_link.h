// RunLink: the gateway's connection to a run, over any transport.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>

#include "transport/protocol/transport.h"
#include "troupe/result.h"
#include "viewer/gateway/edit_operation.h"

namespace troupe {

// An observer that follows a run until it is destroyed; no handler call runs any more then.
class RunObservation {
 public:
  virtual ~RunObservation() = default;
};

class RunLink {
 public:
  virtual ~RunLink() = default;

  // Begins to follow the run, which need not exist yet. The handler outlives the observation.
  virtual Result<std::unique_ptr<RunObservation>> Observe(ObserverHandler& handler) = 0;

  // Sends a request to the run's service and waits for the reply. Called on one thread, another one than Observe.
  virtual Result<ControlReply> Ask(const ControlRequest& request) = 0;

  // An operation of the editor's page (viewer/editor), and an object for the reply. On the thread of Ask.
  virtual Result<nlohmann::json> Edit(const EditOperation& operation) {
    (void)operation;
    return Failure("this page shows a run; troupe edit FILE edits a file");
  }
};

}  // namespace troupe
