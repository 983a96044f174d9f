// A transport to run the contract tests over.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "common/protocol/transport.h"

namespace troupe::test {

// One session: what its service and each of its agents, perhaps processes of their own in earnest, would make for
// themselves. The transports live as long as the rig.
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
  std::function<std::unique_ptr<TransportRig>()> make;  // a session that nobody else uses
  bool loses = false;                                   // frames, so that observers must ask again
  std::uint64_t ticks = 40;                             // length of the whole runs
};

inline void PrintTo(const TransportCase& transport, std::ostream* out) {
  *out << transport.name;
}

}  // namespace troupe::test
