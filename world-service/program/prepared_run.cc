#include "world-service/program/prepared_run.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <utility>

#include "common/base/distinct_files.h"
#include "common/base/identity.h"
#include "common/base/print.h"
#include "common/base/system_error.h"
#include "recording/journal.h"
#include "robot-agent/controller/create_controller.h"
#include "ros/messages/names.h"
#include "world-service/observers/fleet/fleet_gateway.h"
#include "world-service/observers/ros/ros_world_gateway.h"
#include "world-service/replay/continued_run.h"
#include "world-service/replay/journal_history.h"
#include "world-service/replay/journal_rewind.h"

namespace troupe {
namespace {

Result<PreparedRun> LoadFile(const RunSource& source) {
  if (source.file.empty()) {
    return Error{{source.outputs.journal->recording}, "found a journal without a run, expected one to resume"};
  }
  Result<LoadedWorld> loaded = LoadWorld(source.file, source.overrides);
  if (!loaded.ok()) return loaded.error();
  for (const Warning& warning : loaded.value().warnings) fmt::print(stderr, "{}\n", warning.ToString());
  PreparedRun run;
  run.scene = std::make_shared<const Scene>(std::move(loaded.value().world));
  run.files = std::move(loaded.value().files);
  run.expectations = std::move(loaded.value().expectations);
  run.regions = std::move(loaded.value().regions);
  run.site = std::move(loaded.value().site);
  run.site_world = run.scene->world().name;
  run.first_world = WorldOf(run.scene);
  run.options = source.service;
  run.options.settings = loaded.value().settings;
  run.ros_lockstep = loaded.value().ros_lockstep;
  source.run.ApplyTo(run.options.settings);
  run.options.world_file = source.file;
  // Its agents know that it is not the service that they were started for, and not another one that has died since.
  if (source.resume) run.options.first_incarnation = source.successor;
  return run;
}

Result<PreparedRun> Branch(const RunSource& source) {
  Result<BranchedRun> branch =
      BranchRun(source.file, {source.branch.from_tick, source.overrides.seed, source.branch.controllers, source.run,
                              source.service.start_paused});
  if (!branch.ok()) return branch.error();
  PreparedRun run;
  run.scene = branch.value().resumed.scene;
  run.first_world = WorldOf(run.scene);
  run.begin = branch.value().begin;
  run.options = source.service;
  run.options.settings = branch.value().settings;
  run.options.world_file = branch.value().resumed.world_file.value_or("");
  run.options.resumed = std::move(branch.value().resumed);
  if (run.options.settings.ros && source.ros.lockstep.names.empty()) {
    // Ticks wait for the topics of the scenario, if it is still here.
    Result<LoadedWorld> file = LoadWorld(run.begin->source->run().file);
    if (file.ok()) run.ros_lockstep = std::move(file.value().ros_lockstep);
  }
  if (source.resume) run.options.resumed->incarnation = source.successor;  // as in LoadFile
  return run;
}

Result<PreparedRun> Resume(Journal journal, const RunSource& source) {
  const RecordedRun begin = journal.recording.run();
  PreparedRun run;
  run.first_world = std::make_shared<const WorldDescription>(begin.world);
  std::unique_ptr<Recorder> texts;
  RunObservers observers;
  const auto make_texts = [&](const std::shared_ptr<const Scene>& first) -> Result<RunObservers> {
    run.first_world = WorldOf(first);
    Result<std::unique_ptr<Recorder>> made = MakeTextRecorder(*run.first_world, source.outputs);
    if (!made.ok()) return made.error();
    texts = std::move(made).value();
    if (texts != nullptr) observers.push_back(texts.get());
    return observers;
  };
  Result<ResumedRun> resumed = RestoreRun(journal, WritesTexts(source.outputs) ? make_texts : MakeRunObservers());
  if (!resumed.ok()) return resumed.error();
  // One that died before it wrote its number to the journal has told the agents of it perhaps.
  resumed.value().incarnation = std::max(resumed.value().incarnation, source.successor);
  if (texts == nullptr && WritesTexts(source.outputs)) {  // the journal has no state
    // The service died before it committed a state, so the restoring has not asked for the observers.
    if (const Result<RunObservers> made = make_texts(resumed.value().scene); !made.ok()) return made.error();
  }
  Result<std::unique_ptr<RunRecorder>> recorder =
      RunRecorder::Continue(std::move(journal), resumed.value(), RecordingOptionsOf(source.outputs, begin.file));
  if (!recorder.ok()) return recorder.error();
  if (resumed.value().rewind) {
    if (Status failure = FinishRewind(resumed.value(), *recorder.value(), observers); !failure.ok()) {
      return failure.error();
    }
  }
  run.recorders.recordings = {recorder.value().get()};
  run.recorders.observers.push_back(std::move(recorder).value());
  if (texts != nullptr) run.recorders.observers.push_back(std::move(texts));

  run.scene = resumed.value().scene;
  run.options = source.service;
  run.options.settings = begin.settings;
  source.run.ApplyTo(run.options.settings);
  run.options.world_file = resumed.value().world_file.value_or(begin.file);
  // Models may be spawned from all files that the run was loaded from, if they are here.
  Result<LoadedWorld> file = LoadWorld(begin.file, source.overrides);
  if (file.ok()) {
    run.files = std::move(file.value().files);
    run.site = std::move(file.value().site);
    run.site_world = file.value().world.name;
    run.ros_lockstep = file.value().ros_lockstep;
  }
  run.options.resumed = std::move(resumed).value();
  return run;
}

Result<PreparedRun> Prepare(const RunSource& source) {
  if (source.resume) {
    Result<std::optional<Journal>> journal = Journal::OpenToContinue(*source.outputs.journal);
    if (!journal.ok()) return journal.error();
    // A branch copies the states of its source to the journal before its own first tick. If such a journal has no tail
    // and no progress, the run itself has not begun, and is branched once more.
    const bool has_begun =
        journal.value() && !(IsRecordingPath(source.file) && journal.value()->recording.tail().empty() &&
                             journal.value()->progress == RunProgress());
    if (has_begun) return Resume(std::move(*journal.value()), source);
  }
  return IsRecordingPath(source.file) ? Branch(source) : LoadFile(source);
}

// The process that listens at the address; 0: unknown.
pid_t Listener(const LocalAddress& address) {
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return 0;
  ucred peer = {};
  socklen_t size = sizeof peer;
  const bool found = connect(probe, address.get(), address.length) == 0 &&
                     getsockopt(probe, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0;
  close(probe);
  return found ? peer.pid : 0;
}

Status CheckLockstep(const RunSource& source, const RunSettings& settings, const RosLockstep& lockstep) {
  if (lockstep.names.empty()) {
    const RosLockstep& given = source.ros.lockstep;
    const char* const name = given.period          ? "--ros-lockstep-period"
                             : given.limit_seconds ? "--ros-lockstep-limit"
                             : given.ends_at_limit ? "--ros-lockstep-at-limit"
                                                   : nullptr;
    if (name == nullptr) return {};
    return Error{{}, std::string(name) + ": found no ticks that wait for ROS, expected --ros-lockstep"};
  }
  if (!settings.ros) {
    if (source.ros.lockstep.names.empty()) return {};  // a scenario whose ROS the command line has switched off
    return Error{{}, "--ros-lockstep: found a run without ROS, expected --ros"};
  }
  if (settings.mode == Mode::kRealtime) {
    return Error{
        {},
        "found ticks that wait for ROS (--ros-lockstep) in mode realtime (--mode), which waits for none; expected "
        "mode lockstep"};
  }
  if (source.ros.world.clock_rate > 0.0) {
    return Error{{},
                 "--ros-clock-rate: found times between ticks that wait for ROS, expected the times of ticks alone"};
  }
  return {};
}

// A service that is started by hand has no launcher that has looked at its files.
Status CheckOutputs(const RunSource& source, const PreparedRun& run) {
  if (source.resume) return {};
  const OutputFiles& files = source.outputs;
  // A recording is a journal, too.
  const bool has_journal = files.journal && files.journal->recording != files.record;
  const std::vector<OutputName> outputs = {{"--hash-log", files.hash_log},
                                           {"--poses", files.poses},
                                           {"--record", files.record},
                                           {"--trace", source.service.trace.file},
                                           {"--journal", has_journal ? files.journal->recording : ""}};
  return CheckDistinct(outputs, [&] {
    std::vector<std::string> inputs = run.files;
    inputs.push_back(source.file);
    const std::vector<std::string> libraries = LibrariesOf(run.world());
    inputs.insert(inputs.end(), libraries.begin(), libraries.end());
    return inputs;
  });
}

}  // namespace

Result<PreparedRun> PrepareRun(const RunSource& unchecked) {
  RunSource source = unchecked;
  source.overrides.check_controller = CheckController;
  source.overrides.check_in_world = CheckControllerNeeds;
  Result<PreparedRun> run = Prepare(source);
  if (!run.ok()) return run;
  if (Status problem = CheckOutputs(source, run.value()); !problem.ok()) return problem.error();
  ServiceOptions& options = run.value().options;
  options.overrides = source.overrides;
  options.check_goal = CheckGoalOfController;
  RestrictRequests(source.permissions, run.value().world(), run.value().files, options);
  RosLockstep& lockstep = run.value().ros_lockstep;
  lockstep.ReplaceBy(source.ros.lockstep);
  if (Status fault = CheckLockstep(source, options.settings, lockstep); !fault.ok()) return fault.error();
  if (!options.settings.ros) return run;
  // That of a run that is continued was checked; its file may be gone.
  if (source.ros.world.building_map && !run.value().site && !source.resume) {
    return Error{{},
                 "--ros-map building: found a run without the map of a building, expected a building or a scenario on "
                 "one; recordings have no such map"};
  }
  options.check_world = [ros = source.ros, domain = source.domain](const WorldDescription& world) {
    return ros::CheckDomains(world, ros.network.domain, ros.names, domain);
  };
  if (Status domains = options.check_world(run.value().world()); !domains.ok()) return domains.error();
  return run;
}

Result<RunObservers> MakeObservers(PreparedRun& run, const RunSource& source) {
  RunObservers observers;
  const std::optional<ResumedRun>& resumed = run.options.resumed;
  if (run.options.settings.ros) {
    ros::RosOptions ros = source.ros;
    ros.lockstep = run.ros_lockstep;
    RunInRos in_ros{.scene = run.scene, .site = run.site, .site_world = run.site_world};
    in_ros.files = run.options.overrides.allowed;
    in_ros.has_released = resumed && !resumed->is_branch && resumed->frame && resumed->frame->state.tick > 0;
    run.gateway = MakeRosWorldGateway(ros, std::move(in_ros));
    observers.push_back(run.gateway.get());
  }
  if (!resumed || resumed->is_branch) {  // else they were made to continue the journal
    // Robots of a branch and of a rebuilt agent need the states before, which only a recording has.
    const bool needs_memory = resumed || run.options.settings.on_agent_loss == OnAgentLoss::kRebuild;
    OutputFiles outputs = source.outputs;
    outputs.begin = run.begin;
    outputs.expectations = run.expectations;
    outputs.regions = run.regions;
    Result<Recorders> recorders = MakeRecorders(*run.first_world, outputs, run.options.world_file, needs_memory);
    if (!recorders.ok()) return recorders.error();
    run.recorders = std::move(recorders).value();
  }
  if (!source.fleet.broker.url.empty()) {
    const Result<mqtt::Broker> broker = BrokerOf(source.fleet.broker);
    if (!broker.ok()) return broker.error();
    Result<std::unique_ptr<RunObserver>> gateway =
        MakeFleetGateway(broker.value(), source.fleet.wait, run.world(),
                         [](const std::string& line) { PrintPlain(stderr, "{}\n", line); });
    if (!gateway.ok()) return gateway.error();
    run.fleet_gateway = std::move(gateway).value();
    observers.push_back(run.fleet_gateway.get());
  }
  for (const std::unique_ptr<RunObserver>& recorder : run.recorders.observers) observers.push_back(recorder.get());
  run.history = MakeRunHistory(run.recorders.recordings);
  run.options.history = run.history.get();
  return observers;
}

Result<SessionLock> SessionLock::Acquire(std::uint32_t domain, const std::string& session) {
  const std::optional<LocalAddress> address =
      MakeLocalAddress("troupe-world-service/" + std::to_string(domain) + "/" + session);
  if (!address) return Error{{}, "the session name \"" + session + "\" is too long"};

  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return SystemError("cannot make a socket");
  SessionLock lock(descriptor);
  if (bind(descriptor, address->get(), address->length) == 0 && listen(descriptor, 16) == 0) {
    return lock;
  }
  if (errno != EADDRINUSE) {
    return SystemError("cannot lock session \"" + session + "\"");
  }
  const pid_t holder = Listener(*address);
  return Failure("a world service runs in session \"" + session + "\" of domain " + std::to_string(domain) +
                 " already (" + (holder > 0 ? "pid " + std::to_string(holder) : "pid unknown") +
                 "); end it, or use another --session");
}

SessionLock::SessionLock(SessionLock&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

SessionLock::~SessionLock() {
  if (socket_ >= 0) close(socket_);
}

}  // namespace troupe
