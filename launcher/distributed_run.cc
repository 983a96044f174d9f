#include "launcher/distributed_run.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "launcher/agent_fleet.h"
#include "launcher/line_pipe.h"
#include "launcher/merge_scans.h"
#include "launcher/process.h"
#include "launcher/progress.h"
#include "launcher/service_report.h"
#include "launcher/signal_watch.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// How long a process may take to end after it was told to, before it is killed.
constexpr auto kTimeToEnd = std::chrono::seconds(10);
// The same for agents after the service has ended the run: they leave at once unless they hang.
constexpr auto kTimeToLeave = std::chrono::seconds(5);

class DistributedRun {
 public:
  DistributedRun(const RunOptions& options, std::string service_program, std::string agent_program)
      : options_(options), service_program_(std::move(service_program)), agents_(options, std::move(agent_program)) {}

  RunEnd Run();

 private:
  Status StartService();
  void Watch();
  void WaitForAgents();
  // Handles whatever happened, after waiting for it at most until the deadline.
  void HandleSome();
  void HandleReports();
  void Handle(const ReadyReport& ready);
  void Handle(const StartedReport&);
  void Handle(const StatusMessage& status) { progress_.Update(status); }
  void Handle(const EventReport& event) { progress_.TellEvent(event.tick, event.event, event.text); }
  void Handle(const RunSummary& summary) { summary_ = summary; }
  void HandleOutput();
  void HandleEnded(const AgentProcess& agent);
  void Stop();
  void Fail(int exit_status, std::optional<Error> error);
  RunEnd End();

  const RunOptions& options_;
  std::string service_program_;
  SignalWatch signals_;
  LinePipe reports_;
  LinePipe output_;  // what the children say to people
  Progress progress_;
  std::optional<Process> service_;
  AgentFleet agents_;
  Clock::time_point start_ = Clock::now();
  std::optional<Clock::time_point> kill_at_;  // set when told to stop
  std::size_t robots_ = 0;
  double startup_seconds_ = 0.0;
  bool started_ = false;
  bool error_told_ = false;  // by a child
  bool interrupted_ = false;
  std::optional<RunSummary> summary_;
  int exit_status_ = kExitDone;
  std::optional<Error> error_;
};

Status DistributedRun::StartService() {
  std::vector<std::string> command = {service_program_};
  for (std::string& word : ServiceArguments(options_)) command.push_back(std::move(word));
  command.push_back("--report-fd=" + std::to_string(reports_.writing_end()));
  Result<Process> service = Process::Start(command, output_.writing_end(), reports_.writing_end());
  reports_.CloseWritingEnd();
  if (!service.ok()) return service.error();
  service_ = std::move(service).value();
  return std::nullopt;
}

void DistributedRun::HandleSome() {
  int timeout = -1;
  if (kill_at_) {
    auto left = std::chrono::duration_cast<std::chrono::milliseconds>(*kill_at_ - Clock::now());
    timeout = std::max(0, static_cast<int>(left.count()) + 1);
  }
  pollfd waited[] = {{signals_.descriptor(), POLLIN, 0},
                     {output_.reading_end(), POLLIN, 0},
                     {reports_.at_end() ? -1 : reports_.reading_end(), POLLIN, 0}};
  poll(waited, 3, timeout);
  if (signals_.TakeStopRequest()) {
    if (interrupted_) kill_at_ = Clock::now();  // asked twice: at once
    interrupted_ = true;
    Stop();
  }
  // Whether the service has ended is asked before its last words are read, so that none are missed.
  service_->Poll();
  HandleOutput();
  HandleReports();
  for (const AgentProcess* agent : agents_.TakeEnded()) HandleEnded(*agent);
  if (kill_at_ && Clock::now() >= *kill_at_) {
    service_->Kill();
    agents_.Kill();
  }
}

void DistributedRun::HandleOutput() {
  for (const std::string& line : output_.Read()) {
    // Of a hundred agents with the same trouble at the start one is enough.
    bool error = line.starts_with("error: ") || line.find(": error: ") != std::string::npos;
    if (error && error_told_ && !started_) continue;
    error_told_ = error_told_ || error;
    progress_.Tell(line);
  }
}

void DistributedRun::HandleReports() {
  for (const std::string& line : reports_.Read()) {
    std::optional<ServiceReport> report = ParseServiceReport(line);
    if (report) std::visit([this](const auto& content) { Handle(content); }, *report);
  }
}

void DistributedRun::Handle(const ReadyReport& ready) {
  if (kill_at_) return;
  robots_ = ready.robots.size();
  if (Status failure = agents_.Start(ready, output_.writing_end())) Fail(kExitFailed, failure);
}

void DistributedRun::Handle(const StartedReport&) {
  started_ = true;
  startup_seconds_ = std::chrono::duration<double>(Clock::now() - start_).count();
  progress_.Tell(fmt::format("session {}: {} robots in {} agent processes, ready after {:.2f} s", options_.session,
                             robots_, agents_.size(), startup_seconds_));
}

void DistributedRun::HandleEnded(const AgentProcess& agent) {
  const ProcessEnd& end = *agent.process.end();
  if (end.ok() || kill_at_ || summary_ || !service_->running()) return;
  std::string text = (agent.robots.size() == 1 ? "robot " : "robots ");
  for (const std::string& robot : agent.robots) text += (&robot == &agent.robots.front() ? "" : ", ") + robot;
  text += ": the agent (process " + std::to_string(agent.process.pid()) + ") " + end.ToString();
  if (started_) {
    progress_.Tell(text + "; to start it again:\n  " + agent.restart_command);
  } else if (end.exit_code == kExitBadInput || end.exit_code == kExitFailed) {
    Fail(end.exit_code, std::nullopt);  // it has said why
  } else {
    Fail(kExitFailed, Error{{}, text + " before the run began"});
  }
}

void DistributedRun::Fail(int exit_status, std::optional<Error> error) {
  if (exit_status_ != kExitDone) return;
  exit_status_ = exit_status;
  error_ = std::move(error);
  Stop();
}

void DistributedRun::Stop() {
  service_->Signal(SIGTERM);
  if (!started_) agents_.Signal(SIGTERM);
  if (!kill_at_) kill_at_ = Clock::now() + kTimeToEnd;
}

void DistributedRun::Watch() {
  while (service_->running()) HandleSome();
  HandleReports();
  if (exit_status_ != kExitDone) return;
  const ProcessEnd& end = *service_->end();
  if (end.exit_code == kExitBadInput || end.exit_code == kExitFailed) {
    exit_status_ = end.exit_code;  // it has said why
  } else if (interrupted_) {
    exit_status_ = kExitInterrupted;
  } else if (!end.ok() || !summary_) {
    exit_status_ = kExitFailed;
    error_ = Error{{}, "the world service " + end.ToString()};
  }
}

void DistributedRun::WaitForAgents() {
  // After an orderly end they leave by themselves, once they have written what they have to write.
  if (!summary_) agents_.Signal(SIGTERM);
  kill_at_ = Clock::now() + kTimeToLeave;
  while (!agents_.all_ended()) HandleSome();
  output_.CloseWritingEnd();
  HandleOutput();
}

RunEnd DistributedRun::End() {
  RunEnd end;
  end.exit_status = exit_status_;
  end.error = error_;
  // Scans of a run that failed half-way may tell why.
  Status unmerged = started_ && !options_.scans.empty() ? MergeScans(agents_.scan_files(), options_.scans) : Status();
  bool failed = exit_status_ != kExitDone && exit_status_ != kExitInterrupted;
  if (unmerged && !failed) return {kExitFailed, std::nullopt, unmerged};
  if (!summary_ || failed) return end;
  end.outcome.emplace();
  end.outcome->run = *summary_;
  end.outcome->run.startup_seconds = startup_seconds_;
  end.outcome->processes = static_cast<std::uint32_t>(agents_.size() + 1);
  end.outcome->service_peak_memory_mib = service_->end()->peak_memory_mib;
  end.outcome->agent_peak_memory_mib = agents_.peak_memory_mib();
  return end;
}

RunEnd DistributedRun::Run() {
  if (Status failure = StartService()) return {kExitFailed, std::nullopt, failure};
  Watch();
  WaitForAgents();
  return End();
}

}  // namespace

RunEnd RunDistributed(const RunOptions& options) {
  Result<std::string> service_program = FindProgram("world-service");
  if (!service_program.ok()) return {kExitFailed, std::nullopt, service_program.error()};
  Result<std::string> agent_program = FindProgram("robot-agent");
  if (!agent_program.ok()) return {kExitFailed, std::nullopt, agent_program.error()};
  return DistributedRun(options, service_program.value(), agent_program.value()).Run();
}

}  // namespace troupe
