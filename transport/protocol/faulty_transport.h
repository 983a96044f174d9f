// FaultyTransport: wraps another transport, for tests and demonstrations, and loses, delays, duplicates and reorders
// its messages on the way to the handlers. A run must give the same states with it as without: that is the property
// that the tests of the tick protocol check.
//
// Faults are drawn from the seed, the endpoint and a counter of its messages: an endpoint that receives the same
// messages has the same faults. Delays are of the wall clock, so that a run with them is not repeatable in time, only
// in its results.
//
// Threads: one thread delivers for all endpoints; observers have their queues. The news that an agent or a service has
// gone passes without faults, as the lease of DDS does, and so do the requests of tools.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "transport/protocol/transport.h"
#include "troupe/result.h"

namespace troupe {

// Probabilities are of each message. Joins, admissions, frames and proposals are affected; the session message, which a
// transport keeps for latecomers, only by delay.
struct Faults {
  double loss = 0.0;
  double duplicate = 0.0;
  double reorder = 0.0;  // delivered after the next message of its kind
  double delay_probability = 0.0;
  double delay_seconds = 0.0;    // a delayed message waits uniform(0, this)
  double latency_seconds = 0.0;  // mean delay of every message
  double latency_jitter = 0.0;   // largest deviation from it, as a part of it
  std::uint64_t seed = 1;

  bool any() const { return loss > 0 || duplicate > 0 || reorder > 0 || delay_probability > 0 || latency_seconds > 0; }
};

// From "loss=0.1,duplicate=0.05,reorder=0.1,delay=0.2:0.005,latency=0.005:0.2,seed=7" (delay is probability:seconds,
// latency seconds:jitter).
Result<Faults> ParseFaults(const std::string& text);

std::unique_ptr<Transport> MakeFaultyTransport(std::unique_ptr<Transport> inner, const Faults& faults);

}  // namespace troupe
