// SessionMonitor: the sessions that run in a domain, for tools that only watch.
//
// A participant has one set of keys, so that the monitor has one for runs without security and one for each set of keys
// that it finds. A session is identified by its run, not its name: two services may use one name by mistake, and both
// are listed. A service is listed from its session message to its end, or to the end of its lease.
//
// Messages are accepted from the participant that sent a run's session message first; where this user has the token of
// the session, only with its proof (senders.h).
//
// Threads: one at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"

namespace troupe {

struct SessionInfo {
  std::string session;
  RunId run = 0;
  std::string host;  // of its service
  std::uint32_t pid = 0;
  std::string world;
  std::uint32_t robots = 0;
  std::optional<StatusMessage> status;  // the latest, if there was one
};

class SessionMonitor {
 public:
  // Sees services on the same network that multicast reaches, and the one at network.service_address. With security
  // "auto" these are the runs without security, and the secured ones that this user's runs publish on this host; with a
  // folder of keys the runs of its authority; with "off" the runs without security. Throws std::exception when DDS
  // cannot start, or the keys cannot be read.
  explicit SessionMonitor(const NetworkSettings& network);
  ~SessionMonitor();

  // The sessions known now, by name and run. A session is discovered after a moment, and leaves the list when its
  // service ends.
  std::vector<SessionInfo> Sessions();

  // Waits until something may have changed, at most `seconds`.
  void WaitForChange(double seconds);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

inline constexpr double kSimilarSeconds = 1.0;
// The end of a message that a session has not been found: "; did you mean 'demo'?" if one with a similar name runs, or
// nothing. Looks for kSimilarSeconds at most, less if it finds one, or the session itself. Throws as a SessionMonitor.
std::string SimilarSession(const NetworkSettings& network);

// ObserveSession: follows the run of a session.

// An observer of a session until it is destroyed: no handler call runs any more then.
class SessionObserver {
 public:
  virtual ~SessionObserver() = default;
};

// Observes the runs of `network.session`, now and later, as SessionMonitor sees them. With security "auto" the keys are
// the published keys of a run. The handler outlives the observer. The error: no keys of an observer (kBadInput), or DDS
// cannot start.
Result<std::unique_ptr<SessionObserver>> ObserveSession(const NetworkSettings& network, ObserverHandler& handler);

}  // namespace troupe
