// ControlClient: asks the world service of a session to pause, play or step, or to change its world.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/protocol/messages.h"

namespace troupe {

class ControlClient {
 public:
  // Reaches services on the same network that multicast reaches, and the one at `service_address` ("host" or
  // "host:port"). Throws dds::Exception (common/dds/binding/exception.h) when DDS cannot start.
  ControlClient(std::uint32_t domain, const std::string& session, const std::string& network_interface,
                const std::string& service_address = "");
  ~ControlClient();

  // Waits for the service, at most `seconds`. The error is for people.
  Status WaitForService(double seconds);

  // Sends a request and waits for the reply: at most `seconds`; 0: without limit. The error: no reply has arrived.
  Result<ControlReply> Call(ControlRequest request, double seconds);
  Result<ControlReply> Call(ControlCommand command, std::uint64_t ticks, double seconds);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace troupe
