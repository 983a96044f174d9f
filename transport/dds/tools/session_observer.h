// ObserveSession: follows the run of a session.
#pragma once

#include <memory>

#include "common/run/network_settings.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"

namespace troupe {

// An observer of a session until it is destroyed: no handler call runs any more then.
class SessionObserver {
 public:
  virtual ~SessionObserver() = default;
};

// Observes the runs of `network.session`, now and later, as SessionMonitor sees them. With security "auto" the keys are
// those that a run has published by now. The handler outlives the observer. The error: no keys of an observer
// (kBadInput), or DDS cannot start.
Result<std::unique_ptr<SessionObserver>> ObserveSession(const NetworkSettings& network, ObserverHandler& handler);

}  // namespace troupe
