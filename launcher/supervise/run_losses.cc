#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "launcher/supervise/distributed_run.h"

namespace troupe {
namespace {

// s, from a request to a host for a sign of life to the next one, and the number of them without an answer after which
// its agents are lost. Counted, not measured: this process may have been stopped, too.
constexpr double kPingPeriod = 1.0;
constexpr int kMaxPings = 10;

constexpr std::size_t kMaxCommand = 20'000;  // characters that are printed

}  // namespace

// The run goes on without its agents, as `on_agent_loss` says.
void DistributedRun::ReactToLoss(Host& host, const Error& loss) {
  agents_.NoteLostFiles(host);
  if (summary_ || kill_at_) return;
  const bool connects = started_ && &host != &hosts_.service_host() && restarts_.limit() > 0;
  if (connects) hosts_.OnLoss(host, Seconds(Clock::now()));
  progress_.Tell(loss.ToString() + (connects ? "; it is connected again once it can be reached, and its agents are "
                                               "started again"
                                             : ""));
}

void DistributedRun::ReconnectHosts() {
  if (kill_at_ || summary_ || !goes_on()) return hosts_.GiveUp();
  for (Host* host : hosts_.Reconnect(Seconds(Clock::now()))) {
    const auto [first, last] = agents_of_lost_hosts_.equal_range(host);
    progress_.Tell(fmt::format("host {}: connected again; its {} {} started again", host->name(),
                               std::distance(first, last),
                               std::distance(first, last) == 1 ? "agent is" : "agents are"));
    for (auto agent = first; agent != last; ++agent) RestartAgent(agent->second);
    agents_of_lost_hosts_.erase(host);
  }
}

// The service cannot see processes: an agent is lost only when this process says so.
void DistributedRun::TellAgents(const std::vector<std::size_t>& ended) {
  for (const AgentId agent : agents_.DrainStarted()) service_.TellStart(agent);
  for (const std::size_t number : ended) {
    const AgentProcess& agent = agents_.agent(number);
    service_.TellEnd(agent.id, agent.host->connected() ? "its process " + agent.process->end()->ToString()
                                                       : "the connection to its host is lost");
  }
}

// A silent host keeps its connection, since it may only be slow: for the service its agents are lost until it answers.
void DistributedRun::PingHosts() {
  const double now = Seconds(Clock::now());
  if (options_.hosts.empty() || now < next_ping_) return;
  next_ping_ = now + kPingPeriod;
  for (const auto& host : hosts_.all()) {
    const bool answers = host->Ping() < kMaxPings;
    if (answers != silent_hosts_.contains(host.get())) continue;
    answers ? silent_hosts_.erase(host.get()) : silent_hosts_.insert(host.get()).second;
    for (std::size_t number = 0; number < agents_.started(); ++number) {
      const AgentProcess& agent = agents_.agent(number);
      if (agent.host != host.get() || !agent.process->running()) continue;
      if (answers) {
        service_.TellStart(agent.id);
      } else {
        service_.TellEnd(agent.id,
                         fmt::format("host {} has not answered for {:.0f} s", host->name(), kMaxPings * kPingPeriod));
      }
    }
  }
}

// By the agent's exit status, the phase of the run and the restarts that are left: the end of the run, a restart, or a
// robot without an agent, with a command for the user that starts it again.
void DistributedRun::ReactToEnd(const AgentProcess& agent) {
  const ProcessEnd& end = *agent.process->end();
  if (end.exit_code == kExitOutputFailed) {
    return Fail(FailedRun(output_failure_.value_or(Failure("an agent cannot write its output files"))));
  }
  if (!end.ok() && summary_ && !failed()) return NoteIncompleteFiles(agent);
  if (end.ok() || kill_at_ || summary_ || !goes_on()) return;
  const std::string& host = agent.host->name();
  if (hosts_.is_lost(*agent.host)) {
    agents_of_lost_hosts_.emplace(agent.host, agent.number);
    return;
  }
  const std::string text = fmt::format(
      "{} {}: the agent ({}process {}) {}", agent.robots.size() == 1 ? "robot" : "robots", ListText(agent.robots),
      host.empty() ? "" : "on host " + host + ", ", agent.process->pid(), end.ToString());
  // Before the start a refusal is the user's error, which the agent has printed: the run ends with its exit status.
  // Later the same status can only be a fault, and the agent's restarts decide.
  const bool refused = end.exit_code == kExitBadInput || end.exit_code == kExitFailed;
  if (started_ || !refused) {
    const auto [before, is_first] = ended_at_.try_emplace(agent.number, newest_);
    if (rebuilds_ && !is_first && std::exchange(before->second, newest_) != newest_) restarts_.Forgive(agent.number);
    if (restarts_.OnEnd(agent.number, end.exit_code, Seconds(Clock::now()))) {
      progress_.TellOneOfMany(
          fmt::format("{}; restart {} of {}", text, restarts_.CountOf(agent.number), restarts_.limit()));
    } else if (rebuilds_ && restarts_.limit() > 0) {
      // One that was refused, or whose files cannot be written, would end the same way after a restart.
      const std::uint32_t restarts = restarts_.CountOf(agent.number);
      Fail(FailedRun(Failure(restarts < restarts_.limit()
                                 ? text
                                 : fmt::format("{} after {} restarts at tick {}", text, restarts, newest_.tick))));
    } else if (!started_) {
      Fail(FailedRun(Failure(text + " before the run began")));
    } else {
      TellRestartCommand(agent, text);
    }
  } else {
    Fail({end.exit_code, std::nullopt, std::nullopt});
  }
}

// All of a run that ended in order is written, but not the last scans of an agent that died then. An agent that the run
// has lost before is in its summary.
void DistributedRun::NoteIncompleteFiles(const AgentProcess& agent) {
  const auto is_lost = [&](const std::string& robot) {
    return std::find(summary_->lost.begin(), summary_->lost.end(), robot) != summary_->lost.end();
  };
  if (agent.process->end()->exit_code == kExitInterrupted) return;  // it was stopped in order, and its file is whole
  if (options_.scans.empty() || std::all_of(agent.robots.begin(), agent.robots.end(), is_lost)) return;
  if (hosts_.is_lost(*agent.host) || output_failure_) return;
  output_failure_ = Error{{options_.scans},
                          fmt::format("the last scans of {} are missing: the agent (process {}) {}",
                                      ListText(agent.robots), agent.process->pid(), agent.process->end()->ToString()),
                          ErrorCode::kFailure};
}

void DistributedRun::TellRestartCommand(const AgentProcess& agent, const std::string& reason) {
  // The keys of an agent are gone with the connection to its host.
  const Result<std::string> command = agents_.RestartCommand(agent.number);
  if (!agent.host->connected() || !command.ok()) return progress_.TellOneOfMany(reason + "; it is not started again");
  if (command.value().size() > kMaxCommand) {
    return progress_.TellOneOfMany(
        fmt::format("{}; it is not started again (the command for its {} robots is too long to print)", reason,
                    agent.robots.size()));
  }
  const std::string there = agent.host->name().empty() ? "" : " there";
  progress_.TellOneOfMany(reason + "; to start it again" + there + ":", command.value());
}

void DistributedRun::RestartAgent(std::size_t number) {
  const Status status = agents_.Restart(number);
  if (!status.ok()) TellRestartCommand(agents_.agent(number), status.error().ToString());
}

// A restart that is due on a lost host waits for the host, without costing another restart of the limit.
void DistributedRun::RestartAgents() {
  if (kill_at_ || summary_ || !goes_on()) return restarts_.Cancel();
  for (const std::size_t number : restarts_.DrainDue(Seconds(Clock::now()))) {
    Host* const host = agents_.agent(number).host;
    if (hosts_.is_lost(*host)) {
      agents_of_lost_hosts_.emplace(host, number);
    } else {
      ++restarted_;
      RestartAgent(number);
    }
  }
}

// A service that ended in order, or refused its input or its files, would end the same way.
bool DistributedRun::PlanRestartOfService() {
  const ProcessEnd& end = *service_.process().end();
  const bool died = end.exit_code != kExitDone && end.exit_code != kExitBadInput && end.exit_code != kExitFailed &&
                    end.exit_code != kExitOutputFailed && end.exit_code != kExitInterrupted;
  if (!died || failed() || kill_at_ || summary_ || !service_.can_restart()) return false;
  const std::string& host = hosts_.service_host().name();
  const std::string text =
      fmt::format("the world service {}(process {}) {}", host.empty() ? "" : "on host " + host + " ",
                  service_.process().pid(), end.ToString());
  if (!hosts_.service_host().connected()) {
    progress_.Tell(text);
    return false;
  }
  if (service_restarts_.OnDeath(newest_, Seconds(Clock::now()))) {
    progress_.Tell(text + "; it is started again");
    return true;
  }
  progress_.Tell(text + ", time and again at the same tick");
  return false;
}

// The same ports as before: agents and viewer reconnect by the addresses that they have.
void DistributedRun::RestartService() {
  if (!service_restarts_.due() || Seconds(Clock::now()) < *service_restarts_.due()) return;
  if (kill_at_) return service_restarts_.Cancel();
  const Status started = service_.Restart(keys_, service_ports_, started_);
  service_restarts_.OnStart();
  if (!started.ok()) Fail(FailedRun(started.error()));
}

}  // namespace troupe
