#include "launcher/commands/run_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "command_line/terminal.h"
#include "common/base/file.h"
#include "common/base/print.h"
#include "common/spatial/scene_cache.h"
#include "launcher/commands/check_command.h"
#include "launcher/commands/commands.h"
#include "launcher/commands/shown_expectations.h"
#include "launcher/commands/temporary_folder.h"
#include "launcher/process/filter.h"
#include "launcher/process/local_broker.h"
#include "launcher/supervise/output_files.h"
#include "launcher/supervise/reports.h"
#include "launcher/supervise/run_options.h"
#include "launcher/supervise/run_ways.h"
#include "robot-agent/controller/create_controller.h"
#include "ros/messages/names.h"
#include "ros/messages/ros_options.h"
#include "transport/protocol/transport.h"
#include "viewer/gateway/access.h"
#include "viewer/gateway/viewer_gateway.h"
#include "world-service/replay/continued_run.h"
#include "world-service/service/run_observer.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

// The enclaves of the world and of the first robot of each process.
std::vector<std::string> EnclavesOf(const RunOptions& options, const LoadedWorld& loaded) {
  std::vector<std::string> enclaves = {ros::kWorldEnclave};
  if (!options.hosts.empty() || options.in_process) return enclaves;
  const std::vector<std::string> robots = ros::RobotNames(loaded.world);
  const std::uint32_t packing = options.run.robots_per_process.value_or(loaded.settings.robots_per_process);
  for (std::size_t i = 0; i < robots.size(); i += std::max(1U, packing)) enclaves.push_back("/" + robots[i]);
  return enclaves;
}

// Whether ROS's environment is valid, and the participants of a run have their keys for ROS 2, before any process is
// started. Fails for clients of services that this build cannot answer, for a run with ROS whose environment is not
// valid, and with the first enclave whose keys are required and missing; prints a warning where ROS itself would
// continue, and a warning for each that a run in one process does without. Looks at the keystore of this host only, so
// not for the processes of remote hosts, which look themselves. Other faults of the file are left to the run.
// `given`: the options about ROS on the command line, which a run without ROS does not have.
Status CheckRosOptions(const RunOptions& options, const std::vector<std::string>& given) {
  const ros::RosSecurity& security = options.ros.network.security;
  const ros::EnvironmentFaults& faults = options.ros.faults;
  const std::optional<ros::ServiceClients>& clients = options.ros.network.service_clients;
  if (clients && *clients != ros::ServiceClients::kCyclone && !ros::HasFastDds()) {
    return Error{{},
                 fmt::format("--ros-services: found '{}', expected cyclone: Troupe was built without Fast DDS",
                             NameOf(*clients))};
  }
  const bool is_open = security.fault.empty() && security.strategy == ros::SecurityStrategy::kOff;
  const bool is_valid =
      faults.domain.empty() && faults.distribution.empty() && faults.discovery.empty() && faults.rmw.empty();
  if (is_open && is_valid && (given.empty() || options.run.ros)) return Status();
  const Result<LoadedWorld> loaded = LoadWorld(options.file, options.load);
  if (!loaded.ok()) return Status();
  if (!options.run.ros.value_or(loaded.value().settings.ros)) {
    if (given.empty()) return Status();
    return Error{{}, given.front() + ": found a run without ROS 2, expected --ros"};
  }
  for (const std::string& fault : {faults.domain, faults.distribution}) {
    if (!fault.empty()) return Error{{}, fault};
  }
  for (const std::string& warning : {faults.discovery, faults.rmw}) {
    if (!warning.empty()) PrintPlain(stderr, "warning: {}\n", warning);
  }
  if (is_open) return Status();
  for (const std::string& name : EnclavesOf(options, loaded.value())) {
    const Result<ros::Enclave> enclave = ros::FindEnclave(security, name);
    if (!enclave.ok()) return enclave.error();
    // Processes of their own print it themselves.
    if (options.in_process && !enclave.value().warning.empty()) PrintPlain(stderr, "{}\n", enclave.value().warning);
  }
  return Status();
}

constexpr auto kMaxReply = std::chrono::seconds(10);
constexpr int kShowEndMilliseconds = 300;  // for viewers to receive the end of the run
constexpr int kLookMilliseconds = 10;

// Its destructor ends the calls to the handler.
class MemoryObservation : public RunObservation {
 public:
  MemoryObservation(Transport& transport, ObserverHandler& handler) : endpoint_(transport.MakeObserverEndpoint()) {
    endpoint_->Start(handler);
  }

 private:
  std::unique_ptr<ObserverEndpoint> endpoint_;
};

// The viewer of a run in this process: an observer that serves the page from the start of the run on, until it is
// destroyed, and prints its address. Without a viewer, for want of a port, the run is the same.
class InProcessViewer final : public RunObserver, private RunLink {
 public:
  // `session`, `file` of the run: for the page. The transport outlives the run.
  InProcessViewer(Transport& transport, std::shared_ptr<SceneCache> scenes, std::string session, std::string file)
      : transport_(transport), scenes_(std::move(scenes)), session_(std::move(session)), file_(std::move(file)) {}

  ~InProcessViewer() override {
    if (gateway_ == nullptr) return;
    for (int ms = 0; ms < kShowEndMilliseconds && !gateway_->HasShownEnd(); ms += kLookMilliseconds) {
      std::this_thread::sleep_for(std::chrono::milliseconds(kLookMilliseconds));
    }
  }

  // The gateway starts here and not in the constructor: without `start.control` it could not answer a page.
  Status OnBegin(const RunStart& start) override {
    control_ = &start.control;
    ViewerGatewayOptions options;
    options.session = session_;
    options.expectations = ExpectationsOfRun(file_);
    options.token = MakeToken();
    options.scenes = scenes_;
    Result<std::unique_ptr<ViewerGateway>> gateway = ViewerGateway::Start(options, *this);
    if (!gateway.ok()) {
      PrintPlain(stderr, "no viewer: {}\n", gateway.error().message);
      return {};
    }
    gateway_ = std::move(gateway).value();
    fmt::print("{}\n", StyledLine(std::string(kPageLine) + gateway_->Address(), HasStyles(stdout)));
    std::fflush(stdout);
    return {};
  }

  Status OnEnd() override {
    const std::lock_guard lock(control_mutex_);
    control_ = nullptr;
    return {};
  }

 private:
  bool follows_always() const override { return true; }
  Result<std::unique_ptr<RunObservation>> Observe(ObserverHandler& handler) override {
    return std::unique_ptr<RunObservation>(std::make_unique<MemoryObservation>(transport_, handler));
  }

  // Called by threads of the gateway; the request is answered by the thread of the service.
  Result<ControlReply> Ask(const control::Request& request) override {
    // The reply may come after the wait.
    auto promise = std::make_shared<std::promise<ControlReply>>();
    std::future<ControlReply> reply = promise->get_future();
    {
      const std::lock_guard lock(control_mutex_);
      if (control_ == nullptr) return Failure("the run has ended");
      control_->Request(request, [promise](const ControlReply& made) { promise->set_value(made); });
    }
    if (reply.wait_for(kMaxReply) != std::future_status::ready) return Failure("the run has not replied in time");
    return reply.get();
  }

  Transport& transport_;
  const std::shared_ptr<SceneCache> scenes_;
  const std::string session_;
  const std::string file_;
  std::mutex control_mutex_;
  WorldControl* control_ = nullptr;  // null: the run has not begun, or has ended
  std::unique_ptr<ViewerGateway> gateway_;
};

// Has the paths of a problem planned by the command of --planner, before anything else reads it. `folder`: of their
// file, if the user names none.
Status PlanPaths(RunOptions& options, const TemporaryFolder& folder) {
  GridOptions& grid = options.load.grid;
  const std::string file = grid.paths.empty() ? folder.path() + "/planned.paths" : grid.paths;
  grid.paths.clear();
  if (!IsGridPath(options.file)) {
    return Error{{options.file},
                 "found no problem of paths for --planner, expected .scen, .pogema or a problem of the "
                 "League (.json)"};
  }
  const Result<GridProblem> problem = ReadGridProblem(options.file, grid);
  if (!problem.ok()) return problem.error();
  SignalWatch signals;
  const Result<std::string> paths = RunFilter(options.planner, ProblemJson(problem.value()) + "\n", signals);
  if (!paths.ok()) return paths.error();
  if (Status status = WriteWholeFile(file, paths.value()); !status.ok()) return status;
  grid.paths = file;
  // The command is to blame, and the file may be gone when the user looks.
  const Result<GridProblem> planned = ReadGridProblem(options.file, grid);
  if (planned.ok()) return Status();
  Error error = planned.error();
  error.message += " (in the output of --planner)";
  return error;
}

}  // namespace

// All checks come before any process starts: a bad command line costs no time and leaves no file.
int RunWorld(RunOptions options, const std::vector<std::string>& ros_options) {
  std::optional<TemporaryFolder> folder;
  if (!options.planner.empty()) {
    const Status planned = PlanPaths(options, folder.emplace());
    if (!planned.ok()) return Fail(planned.error());
  }
  if (const Status status = CompleteRunOptions(options); !status.ok()) return Fail(status.error());
  if (const Status status = CheckOutputs(options); !status.ok()) return Fail(status.error());
  if (const Status status = CheckControllers(options.file, options.load.controller); !status.ok()) {
    return Fail(status.error());
  }
  for (const std::string& text : options.branch.controllers) {
    const Result<ControllerChange> change = ParseControllerChange(text);
    if (!change.ok()) return Fail(change.error());
    const ControllerDescription& controller = change.value().controller;
    if (const Status status = CheckController(controller.name, controller.parameters); !status.ok()) {
      return Fail({{}, "option --controller: " + status.error().message});
    }
  }
  // Cyclone does not keep two identities in one process apart that are in one domain.
  std::string& enclave = options.ros.network.security.enclave;
  if (options.in_process && enclave.empty()) enclave = ros::kWorldEnclave;
  if (const Status status = CheckRosOptions(options, ros_options); !status.ok()) return Fail(status.error());
  const TemporaryFolder broker_folder;
  std::unique_ptr<LocalBroker> broker;  // outlives the run
  if (options.fleet.broker.url == "local") {
    Result<std::unique_ptr<LocalBroker>> started = LocalBroker::Start(broker_folder.path());
    if (!started.ok()) return Fail(started.error());
    broker = std::move(started).value();
    options.fleet.broker.url = broker->Url();
    fmt::print("broker: {}\n", options.fleet.broker.url);
    std::fflush(stdout);
  } else if (!options.fleet.broker.url.empty()) {
    const Result<mqtt::Broker> valid = BrokerOf(options.fleet.broker);
    if (!valid.ok()) return Fail(valid.error());
  }
  const MakeViewer make_viewer = [&options](Transport& transport, std::shared_ptr<SceneCache> scenes) {
    return std::make_unique<InProcessViewer>(transport, std::move(scenes), options.network.session, options.file);
  };
  const ReportEnd report = [&options](const RunEnd& end) {
    if (end.error) fmt::print(stderr, "{}\n", StyledLine(PlainLine(end.error->ToString()), HasStyles(stderr)));
    if (!end.outcome) return end.exit_status;
    fmt::print("{}", SummaryText(*end.outcome, {options.stats, HasStyles(stdout)}));
    std::fflush(stdout);
    if (!options.summary.empty()) {
      const Status status = WriteWholeFile(options.summary, SummaryJson(*end.outcome) + "\n");
      if (!status.ok()) return Fail(status.error());
    }
    return end.exit_status;
  };
  return options.in_process ? RunInProcess(options, make_viewer, report) : RunDistributed(options, report);
}

void AddRunCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("run", "Run a world: a world service, and a process for each robot");
  const auto options = std::make_shared<RunOptions>();
  AddRunOptions(*command, *options);
  command->final_callback([command, options, &exit_status] {
    std::vector<std::string> ros_options;
    for (const CLI::Option* const option : command->get_options()) {
      if (option->get_name().starts_with("--ros-") && option->count() > 0) ros_options.push_back(option->get_name());
    }
    exit_status = RunWorld(*options, ros_options);
  });
}

}  // namespace troupe
