// NetworkLog: the messages of Cyclone DDS about the network, for instance about samples whose layout is not that of
// their type, limited as by FloodLimiter.
//
// Cyclone has one sink for a process. Its messages may be caused by strangers on the network, so that they are limited
// and made plain lines.
#pragma once

#include <string>

#include "common/base/text.h"

namespace troupe::dds {

// One for a process, which outlives its participants. Without one, Cyclone prints to standard error.
class NetworkLog {
 public:
  explicit NetworkLog(FloodLimiter::Tell tell);
  ~NetworkLog();
  NetworkLog(const NetworkLog&) = delete;
  NetworkLog& operator=(const NetworkLog&) = delete;

 private:
  FloodLimiter lines_;
};

// Leaves out from now on that a secured participant was refused. Cyclone says so of each one of which it hears between
// the start of a domain and that of its first participant; it hears of it again. For processes with secured
// participants.
void LeaveOutEarlyParticipants();

// For a tool: prints the first message of the process alone, to standard error. Tools look again and again for a
// service that no packet may reach.
void PrintFirstNetworkMessage();

}  // namespace troupe::dds
