// Whole runs over a transport: a world service and its agents, each in a thread of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/contract/transport_case.h"
#include "world-service/service/run_service.h"

namespace troupe::test {

// Robots that drive among walls and into each other.
WorldDescription BusyWorld();

struct WholeRun {
  std::vector<std::vector<std::string>> agents;  // the robots of each, in the order in which the agents start
  bool service_first = true;                     // or last
  std::uint64_t ticks = 40;
  std::function<void()> before_agents = {};  // called when the service has started, if it is first
};

struct WholeRunResult {
  RunSummary summary;
  std::string hash_log;  // all of it
};

// Runs the busy world; failures are those of the test that calls.
WholeRunResult RunBusyWorld(TransportRig& rig, const WholeRun& run);

}  // namespace troupe::test
