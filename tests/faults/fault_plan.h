// FaultPlan: everything that a seed decides: the run, its agents, the network, the faults and the requests of tools.
// Times are virtual, s.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "transport/protocol/messages.h"

namespace troupe::faults {

// The faults of each message, as in transport/protocol/faulty_transport.h.
struct MessageFaults {
  double loss = 0.0;
  double duplicate = 0.0;
  double reorder = 0.0;  // delivered after later messages
  double least_delay = 0.0;
  double most_delay = 0.0;
};

enum class FaultKind : std::uint8_t {
  kStop,          // the process is stopped (SIGSTOP), and continues after `seconds`
  kKill,          // the process is killed; `seconds` means nothing
  kKillInCommit,  // of the service: it is killed in its next tick, when that is in the journal and nowhere else
  kPartition,     // no message passes between the service and the agent
  kPartitionTo,   // none from the service to the agent
  kPartitionFrom  // none from the agent to the service
};

struct ProcessFault {
  FaultKind kind = FaultKind::kStop;
  double at = 0.0;
  double seconds = 0.0;
  std::size_t victim = 0;  // 0: the service; n: the n-th agent that lives then, counted round
  bool all_agents = false;
};

struct PlannedRequest {
  double at = 0.0;
  control::Request request;
};

// An observer joins, is stopped for a time, and leaves without a message.
struct PlannedObserver {
  double joins_at = 0.0;
  double stops_at = 0.0;
  double stopped_seconds = 0.0;   // 0: never
  std::optional<double> dies_at;  // nothing: it stays
};

struct FaultPlan {
  std::uint64_t seed = 0;
  std::size_t robots = 1;
  std::size_t packing = 1;  // robots of an agent
  RunSettings settings;
  double lease = 1.0;
  double start_timeout = 60.0;
  double session_timeout = 60.0;
  bool start_paused = false;
  // Controllers remember, so that only agents that keep their replicas give the same result.
  bool memory = false;
  std::uint32_t restarts = 0;  // of each agent, by the launcher
  MessageFaults messages;
  std::vector<ProcessFault> faults;  // all end before faults_end
  std::vector<PlannedRequest> requests;
  std::vector<PlannedObserver> observers;
  double faults_end = 0.0;
  // No fault is as long as a lease or the deadline: no agent may be lost.
  bool gentle = false;
  bool only_deaths = false;      // no process is stopped or cut off, so that each agent joins for robots that need one
  bool service_dies = false;     // for good
  bool service_returns = false;  // each time that it dies, another one continues the run from its journal
};

FaultPlan MakePlan(std::uint64_t seed);

}  // namespace troupe::faults
