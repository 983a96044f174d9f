// SessionMonitor: the sessions that run in a domain, for tools that only watch.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/messages.h"

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
  // Sees services on the same network that multicast reaches, and the one at `service_address` ("host" or "host:port").
  // Throws dds::Exception (common/dds/binding/exception.h) when DDS cannot start.
  SessionMonitor(std::uint32_t domain, const std::string& network_interface, const std::string& service_address = "");
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

}  // namespace troupe
