// LocalBroker: Debian's MQTT broker `mosquitto` on the loopback interface, for one run.
#pragma once

#include <memory>
#include <string>

#include "launcher/process/process.h"
#include "troupe/result.h"

namespace troupe {

class LocalBroker {
 public:
  // Starts it on port 1883, or on a free one if that is taken, and waits until it accepts connections. `folder`: for
  // its settings; outlives it. The error is a program that is not installed, or that does not start.
  static Result<std::unique_ptr<LocalBroker>> Start(const std::string& folder);

  // "mqtt://127.0.0.1:1883"
  std::string Url() const;

 private:
  LocalBroker(Process process, int port) : process_(std::move(process)), port_(port) {}

  Process process_;
  int port_;
};

}  // namespace troupe
