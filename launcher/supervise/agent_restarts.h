// AgentRestarts: decides whether and when an agent that ended is started again. Without a clock and processes of its
// own: times are in s, of any clock that does not decrease.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace troupe {

class AgentRestarts {
 public:
  using Agent = std::size_t;  // a number that the caller chooses; it stays that of the agents started again

  // `limit`: of the restarts of each agent; 0: none.
  explicit AgentRestarts(std::uint32_t limit = 0) : limit_(limit) {}

  // REQUIRES: the run has begun and goes on. An agent ended with this exit status (128 and the signal's number if a
  // signal ended it). The time of its restart, which is later each time; nothing if it is not started again: it ended
  // in order, or refused its input or its output files, where another attempt would end likewise, or its restarts are
  // used up.
  std::optional<double> OnEnd(Agent agent, int exit_status, double now);

  // The run has advanced since the agent ended: its restarts are counted anew.
  void Forgive(Agent agent) { counts_.erase(agent); }

  // The agents whose time has come, by number, each of them once.
  std::vector<Agent> TakeDue(double now);
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

}  // namespace troupe
