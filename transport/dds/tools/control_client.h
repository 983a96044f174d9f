// ControlClient: asks the world service of a session to pause, play or step, or to change its world. For tools:
// troupectl, the viewer, the launcher.
//
// A client is one random number; its requests have ascending numbers, and a reply counts if both match, so that any
// number of tools can ask one service at a time. Each request is sent once: the topic is reliable, and the client has
// matched a service before it sends. A reply of a service that appeared after the request is not waited for.
//
// The keys of a secured run are looked for in each wait for the service, since a run may publish them after the tool
// has started.
//
// Threads: one at a time. Calls wait on it; Cyclone's own threads receive.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/run/run_settings.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe {

class ControlClient {
 public:
  // A client of the service of `network.session`. It reaches services on the same network that multicast reaches, and
  // the one at network.service_address.
  explicit ControlClient(const NetworkSettings& network);
  ~ControlClient();

  // Waits for the service, at most `seconds`, and then for its first answer, at most 2 s. The error has a text to be
  // shown; kBadInput: the keys of network.security do not belong to an operator. Throws dds::Exception
  // (transport/dds/binding/entity.h) when DDS cannot start.
  Status WaitForService(double seconds);

  // Sends a request and waits for the reply: at most `seconds`; 0: without limit. The error: no reply has arrived,
  // or WaitForService has not succeeded before.
  Result<ControlReply> Call(const control::Request& request, double seconds);

 private:
  class Connection;
  NetworkSettings network_;
  std::unique_ptr<Connection> connection_;  // null: none yet
};

}  // namespace troupe
