// FaultSimulation: one run on virtual time, in one thread: service, agents, launcher, tools and network as a FaultPlan
// says, and the conditions that hold for every run (docs/fault-simulation.md).
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "launcher/supervise/restarts.h"
#include "tests/faults/fault_plan.h"
#include "tests/faults/network.h"
#include "tests/faults/reference_run.h"
#include "tests/faults/simulated_peers.h"
#include "transport/dds/transport/dds_service_endpoint.h"
#include "transport/protocol/run_progress.h"
#include "world-service/service/resumed_run.h"
#include "world-service/service/run_observer.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe::faults {

// KeptJournal: the part of a run's journal that a service needs to continue it, in memory.
class KeptJournal final : public RunObserver {
 public:
  explicit KeptJournal(const std::shared_ptr<const Scene>& scene) : original_(scene), scene_(scene) {}

  // Called once after the next commit.
  void SetOnCommit(std::function<void()> call) { on_commit_ = std::move(call); }

  ResumedRun Resume(RunId run) const {
    return {.run = run,
            .incarnation = incarnation_ + 1,
            .original = original_,
            .scene = scene_,
            .frame = frame_,
            .progress = progress_};
  }
  // Another service continues.
  void SetIncarnation(Incarnation incarnation) { incarnation_ = incarnation; }

  Status OnCommit(const CommittedTick& tick, const RunProgress& progress) override {
    frame_ = tick.frame;
    progress_ = progress;
    if (tick.edit != nullptr && control::Is<control::LoadWorld>(tick.edit->request)) original_ = scene_;
    if (on_commit_) std::exchange(on_commit_, nullptr)();
    return {};
  }
  Status OnProgress(const RunProgress& progress) override {
    progress_ = progress;
    return {};
  }
  void OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition) override { scene_ = scene; }

 private:
  std::shared_ptr<const Scene> original_;
  std::shared_ptr<const Scene> scene_;
  std::optional<FrameMessage> frame_;
  RunProgress progress_;
  Incarnation incarnation_ = 0;
  std::function<void()> on_commit_;
};

struct SimulationResult {
  std::string violation;   // empty: none
  Tick ticks = 0;          // that were committed, edits included
  std::uint64_t hash = 0;  // of the last
  double seconds = 0.0;    // virtual
  std::uint64_t lost = 0;  // agents, each time
};

class FaultSimulation final : private ServiceEndpoint {
 public:
  // `log`: receives the events of the run, a line each; may be empty.
  explicit FaultSimulation(const FaultPlan& plan, std::function<void(const std::string&)> log = {});

  SimulationResult Run();

 private:
  // A group of robots for which the launcher keeps an agent.
  struct Group {
    std::vector<std::string> robots;
    bool joins_late = false;  // the run goes on
  };
  struct SentRequest {
    std::size_t kind = 0;  // index of the alternative of control::Request
    bool arrived = false;
    bool lost = false;  // with a service that died
    int replies = 0;
  };

  // ServiceEndpoint:
  void Start(ServiceHandler&) override {}
  void SendSession(const SessionMessage& session) override;
  void SendAdmissions(const std::vector<AdmissionMessage>& admissions) override;
  void SendFrame(const FrameMessage& frame) override;
  void SendHistory(const HistoryMessage& history) override;
  void SendStatus(const StatusMessage&) override {}
  void Flush(double) override {}

  // The service's process.
  void CallService(const std::function<void(double now)>& call);
  void ActAsService();
  void WakeService(double time);
  void MakeCoordinator();
  void KillService();
  void ReturnService();
  void DeliverSession(ProcessId agent);

  // The launcher.
  void Launch(const std::vector<std::string>& robots, double longest_delay);
  // The next id of an agent or an observer.
  ProcessId NewProcess() const { return agents_.size() + observers_.size() + 1; }
  void StartAgent(std::size_t group);
  void OnAgentEnd(std::size_t group, int exit_status);
  void AwaitRestarts();
  void RestartAgents();
  // The owner starts agents for robots that have none.
  void StartMissingAgents();

  void AddAgent(ProcessId id, const AgentOptions& options, std::size_t group);
  // Observers.
  void AddObserver(const PlannedObserver& plan);
  void OnRequestOfObserver();
  void SendToObservers(const FrameMessage& frame, const WorldState* base, bool requested);
  void CheckShown(ProcessId observer, const FrameMessage& frame);
  bool ObserversHaveShown(Edition edition, Tick tick) const;

  void ToAgent(ProcessId agent, std::function<void(AgentProtocol&)> call);
  void Inject(const ProcessFault& fault);
  void InjectInto(ProcessId victim, const ProcessFault& fault);
  void SendRequest(const control::Request& request);
  std::vector<SimulatedAgent*> LivingAgents() const;

  // Advances until the condition holds, at most `seconds`; false if it does not hold then.
  template <typename Condition>
  bool Await(const Condition& condition, double seconds);
  void RunWithFaults();
  void CheckRecovery();
  void CheckEnd();
  bool IsConsistent() const;
  std::string DescribeInconsistency() const;
  void CheckRequests();
  void CheckMemory();
  void Violate(const std::string& text);
  template <typename... Parts>
  void Log(fmt::format_string<Parts...> format, Parts&&... parts);
  bool service_runs() const { return !network_.HasEnded(kService); }
  // It runs, or another one will.
  bool run_goes_on() const { return service_runs() || returning_; }

  const FaultPlan plan_;
  const std::function<void(const std::string&)> log_;
  EventQueue events_;
  Network network_;
  RandomSource random_;
  std::shared_ptr<const Scene> scene_;
  ReferenceRun reference_;
  KeptJournal journal_;
  bool dies_in_commit_ = false;  // nothing that it sends leaves its process any more
  bool returning_ = false;       // the service has died, and another one will continue
  std::optional<TickCoordinator> coordinator_;
  std::shared_ptr<const SessionMessage> session_;
  std::map<ProcessId, std::shared_ptr<const SessionMessage>> session_sent_;  // to each agent
  std::map<ProcessId, bool> session_received_;
  std::map<ProcessId, bool> join_received_;
  std::uint64_t wake_ = 0;
  double wake_at_ = -1.0;
  std::map<ProcessId, std::unique_ptr<SimulatedAgent>> agents_;  // also those that have ended
  std::vector<Group> groups_;
  int launching_ = 0;             // agents that the launcher is about to start
  Edition launched_edition_ = 0;  // the newest with robots for which agents were started
  AgentRestarts restarts_;
  dds::FrameStream stream_;
  std::map<ProcessId, std::unique_ptr<SimulatedObserver>> observers_;  // also those that have ended
  std::vector<SentRequest> requests_;
  std::string violation_;
  std::uint64_t lost_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace troupe::faults
