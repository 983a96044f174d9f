// Restarts: whether and when a process of a run that ended is started again. Without a clock and processes of their
// own: times are in s, of any clock that does not decrease.
//
// Delays double from restart to restart up to a maximum: a process that dies of a passing cause (memory, network) is
// back soon, and one that dies at once each time does not load the machine. A process whose end would repeat itself
// (bad input, an output file that cannot be written) is not restarted at all.
//
// The service has no limit in number, but one of deaths without progress: a tick that kills it would kill it again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "transport/protocol/messages.h"

namespace troupe {

// The restarts of agents.
class AgentRestarts {
 public:
  using Agent = std::size_t;  // a number that the caller chooses; it stays that of the agents started again

  // `limit`: of the restarts of each agent; 0: none.
  explicit AgentRestarts(std::uint32_t limit = 0) : limit_(limit) {}

  // REQUIRES: the run has begun, and has not ended. An agent ended with this exit status (128 and the signal's number
  // if a signal ended it). The time of its restart, which is later each time; nothing if it is not started again: it
  // ended in order, or refused its input or its output files, where another attempt would end the same way, or its
  // restarts are used up.
  std::optional<double> OnEnd(Agent agent, int exit_status, double now);

  // The run has advanced since the agent ended: its restarts are counted from zero.
  void Forgive(Agent agent) { counts_.erase(agent); }

  // The agents whose time has come, by number, each of them once.
  std::vector<Agent> DrainDue(double now);
  // The time of the next restart; nothing: none is pending.
  std::optional<double> NextDue() const;
  // No pending restart is made. For the end of the run.
  void Cancel() { due_.clear(); }

  std::uint32_t limit() const { return limit_; }
  // The restarts of an agent so far, the pending one included.
  std::uint32_t CountOf(Agent agent) const;

 private:
  // The first time from `from` on that is not close to another restart.
  double FreeTime(double from) const;

  std::uint32_t limit_;
  std::map<Agent, std::uint32_t> counts_;
  std::map<Agent, double> due_;
};

// The restarts of the world service.
class ServiceRestarts {
 public:
  // A service died after it had reported this state: the time of its restart, at once for the first that makes no
  // progress, and later for each that follows. Nothing when it makes none time and again: another would die the same
  // way.
  std::optional<double> OnDeath(const StatePlace& newest, double now);

  const std::optional<double>& due() const { return due_; }
  // The service is started: the restart is made.
  void OnStart() {
    due_.reset();
    ++count_;
  }
  void Cancel() { due_.reset(); }
  std::uint32_t count() const { return count_; }  // restarts that were made

 private:
  std::optional<StatePlace> newest_;    // state at the last death
  std::uint32_t without_progress_ = 0;  // deaths at this state
  std::optional<double> due_;
  std::uint32_t count_ = 0;
};

}  // namespace troupe
