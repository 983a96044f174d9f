// NetworkLog: the messages of Cyclone DDS about the network, for instance about samples whose layout is not that of
// their type, limited as by FloodLimiter.
#pragma once

#include <string>

#include "common/base/flood_limiter.h"

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

}  // namespace troupe::dds
