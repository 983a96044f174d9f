#include "launcher/supervise/restarts.h"

#include <algorithm>
#include <cmath>

#include "command_line/parse_command_line.h"

namespace troupe {
namespace {

// s, before a restart.
constexpr double kFirstDelay = 0.1;
constexpr double kMaxDelay = 10.0;
constexpr int kMaxDoublings = 20;
// s, between two restarts: a hundred agents that die together, on an overloaded host, are not all started together.
constexpr double kSpacing = 0.025;

constexpr int kExitNotStarted = 127;  // its program could not be executed

// An agent that ended for another reason died: by a signal, or by a failure that may not return.
bool MayBeRestarted(int exit_status) {
  return exit_status != kExitNotStarted && exit_status != kExitDone && exit_status != kExitBadInput &&
         exit_status != kExitOutputFailed && exit_status != kExitInterrupted;
}

double DelayBefore(std::uint32_t restart) {
  const int doublings = static_cast<int>(std::min<std::uint32_t>(restart - 1, kMaxDoublings));
  return std::min(kMaxDelay, std::ldexp(kFirstDelay, doublings));
}

constexpr std::uint32_t kMaxWithoutProgress = 8;
constexpr double kSecondDelay = 0.1;  // s, before the second restart at one tick

}  // namespace

// A restart that is still pending is replaced: an agent has one process.
std::optional<double> AgentRestarts::OnEnd(Agent agent, int exit_status, double now) {
  if (!MayBeRestarted(exit_status) || CountOf(agent) >= limit_) return std::nullopt;
  due_.erase(agent);
  const double due = FreeTime(now + DelayBefore(++counts_[agent]));
  due_[agent] = due;
  return due;
}

// By times only, and not by the order of the map: the result does not depend on the agents' numbers.
double AgentRestarts::FreeTime(double from) const {
  std::vector<double> taken;
  for (const auto& [agent, due] : due_) taken.push_back(due);
  std::sort(taken.begin(), taken.end());
  for (const double due : taken) {
    // Ascending, so one pass finds a free time: each shift is towards times that are still to be compared.
    if (std::abs(due - from) < kSpacing) from = due + kSpacing;
  }
  return from;
}

std::vector<AgentRestarts::Agent> AgentRestarts::DrainDue(double now) {
  std::vector<Agent> agents;
  for (const auto& [agent, due] : due_) {
    if (due <= now) agents.push_back(agent);
  }
  for (const Agent agent : agents) due_.erase(agent);
  return agents;
}

std::optional<double> AgentRestarts::NextDue() const {
  std::optional<double> next;
  for (const auto& [agent, due] : due_) next = std::min(next.value_or(due), due);
  return next;
}

std::uint32_t AgentRestarts::CountOf(Agent agent) const {
  const auto count = counts_.find(agent);
  return count == counts_.end() ? 0 : count->second;
}

// Progress is a newer state, not a longer life: a service that loads a large world for a minute and dies at the same
// tick has made none.
std::optional<double> ServiceRestarts::OnDeath(const StatePlace& newest, double now) {
  without_progress_ = newest_ == newest ? without_progress_ + 1 : 0;
  newest_ = newest;
  if (without_progress_ >= kMaxWithoutProgress) return std::nullopt;
  const double delay = without_progress_ == 0 ? 0.0 : std::ldexp(kSecondDelay, static_cast<int>(without_progress_) - 1);
  due_ = now + delay;
  return due_;
}

}  // namespace troupe
