// A transport to run the contract tests over.
#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "transport/protocol/transport.h"

namespace troupe::test {

// One session: the transports of its service and of each of its agents, as processes of their own would make them. The
// transports live as long as the rig.
class TransportRig {
 public:
  virtual ~TransportRig() = default;
  // Each call is for one more service of the same session.
  virtual Transport& ForService() = 0;
  // Each call is for one more agent process.
  virtual Transport& ForAgent() = 0;
  // Each call is for one more observer process.
  virtual Transport& ForObserver() = 0;
};

struct TransportCase {
  std::string name;
  std::function<std::unique_ptr<TransportRig>()> make;  // a session of its own
  bool loses = false;                                   // frames, so that observers must resend requests
  std::uint64_t ticks = 40;                             // length of the whole runs
};

inline void PrintTo(const TransportCase& transport, std::ostream* out) {
  *out << transport.name;
}

}  // namespace troupe::test
