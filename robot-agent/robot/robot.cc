#include "robot-agent/robot/robot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio_ext.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>

#include "common/base/file.h"
#include "common/base/output_file.h"
#include "common/base/prefetch.h"
#include "common/base/system_error.h"
#include "common/base/text.h"
#include "common/spatial/body_index.h"
#include "common/spatial/check_order.h"
#include "common/spatial/scene.h"
#include "common/trace/tick_trace.h"
#include "robot-agent/controller/create_controller.h"
#include "robot-agent/navigation/surroundings.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

// Separates a controller's random numbers from the sensors', whose keys have the same seed and robot.
constexpr std::uint64_t kControllerStream = 0x636f6e74726f6c;

constexpr std::size_t kMaxReport = 300;  // bytes

std::vector<LeafSweep> SweepsOf(const WorldDescription& world, const DoorDescription& door) {
  std::vector<LeafSweep> sweeps;
  for (const DoorLeaf& leaf : door.leaves) {
    if (leaf.turn == 0.0) continue;
    const ModelId object = world.objects[leaf.object.index()];
    double radius = 0.0;
    for (const Block& block : world.shape(world.model(object).shape).blocks) {
      for (const Vec2& corner : block.outline) radius = std::max(radius, corner.norm());
    }
    sweeps.push_back({leaf.X_WH.translation(), radius});
  }
  return sweeps;
}

double TimeOf(const WorldDescription& world, Tick tick) {
  return static_cast<double>(tick) * static_cast<double>(world.interval_ns) / 1e9;
}

Status CheckFleetMessages(const std::vector<FleetMessage>& messages) {
  if (messages.size() > kMaxFleetMessages) {
    return Error{
        {},
        fmt::format("sends {} messages to its fleet control, expected at most {}", messages.size(), kMaxFleetMessages)};
  }
  for (const FleetMessage& message : messages) {
    if (IsToVehicle(message.topic)) return Error{{}, "sends a message that only a fleet control sends"};
    if (message.text.size() > kMaxFleetBytes) {
      return Error{{},
                   fmt::format("sends a message of {} bytes to its fleet control, expected at most {}",
                               message.text.size(), kMaxFleetBytes)};
    }
  }
  return {};
}

// The bytes of the whole lines of the file; 0 if there is none.
Result<off_t> LengthOfWholeLines(const std::string& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return off_t{0};
  Result<LineFile> file = LineFile::Open(path, LineFile::Space::kKeep);
  if (!file.ok()) return file.error();
  off_t length = 0;
  for (std::string line; file.value().Next(line);) length += static_cast<off_t>(line.size()) + 1;
  if (!file.value().status().ok()) return file.value().status().error();
  return length;
}

}  // namespace

Robot::Robot(const Scene& scene, RobotId id, ScanLog* scan_log)
    : scene_(&scene),
      id_(id),
      scan_log_(scan_log),
      odometry_(scene.world().robot(id).localization),
      manipulator_(scene.world(), id),
      sensors_(scene, id) {
  for (const GripperInfo& gripper : manipulator_.grippers()) {
    if (gripper.description->autosnatch && gripper.beams) sensors_.Subscribe(*gripper.beams);
  }
}

Result<std::unique_ptr<Robot>> Robot::Create(const Scene& scene, RobotId id, const RobotOptions& options) {
  std::unique_ptr<Robot> robot(new Robot(scene, id, options.scan_log));
  if (const Status status = robot->StartController(options.libraries); !status.ok()) {
    Error error = status.error();
    error.message = fmt::format("robot {}: {}", robot->description().name, error.message);
    return error;
  }
  return robot;
}

Result<std::unique_ptr<Robot>> Robot::Clone() const {
  std::unique_ptr<Robot> copy(new Robot(*scene_, id_, nullptr));
  // All that the next decision depends on. The scan log is left out: a copy writes no log.
  copy->odometry_ = odometry_;
  copy->manipulator_ = manipulator_;
  copy->sensors_.CopyReadings(sensors_);
  copy->failure_ = failure_;
  copy->accepts_goals_ = accepts_goals_;
  copy->goal_ = goal_;
  if (!failure_.empty()) return copy;  // its controller is never called again
  std::string problem = "cannot be copied";
  try {
    copy->controller_ = controller_->Clone();
  } catch (const std::exception& exception) {
    problem = exception.what();
  } catch (...) {
    problem = "threw something that is not a std::exception";
  }
  copy->watcher_ = dynamic_cast<RobotWatcher*>(copy->controller_.get());
  if (copy->controller_ != nullptr) return copy;
  return Failure(
      fmt::format("robot {}: controller {}: {}", description().name, description().controller.name, problem));
}

Status Robot::CheckCommand(const Command& command) const {
  // On a copy: a refused command must leave no trace.
  Manipulator trial = manipulator_;
  Status status = trial.Apply(command);
  if (status.ok()) status = CheckOrders(command);
  if (status.ok()) return {};
  return Error{{}, fmt::format("robot {}: {}", description().name, status.error().message)};
}

Status Robot::CheckOrders(const Command& command) const {
  Status status = CheckReceivers(command);
  if (status.ok()) status = CheckFleetMessages(command.fleet);
  for (const Order& order : command.orders) {
    if (!status.ok()) break;
    status = CheckOrder(*scene_, id_, WithinLimits(scene_->world(), id_, order));
  }
  return status;
}

Status Robot::CheckReceivers(const Command& command) const {
  for (const RadioMessage& message : command.messages) {
    if (FindRadio(description(), message.radio) == nullptr) {
      return Error{{}, fmt::format("sends a message by sensor {}, expected a radio of the robot", message.radio)};
    }
    const std::size_t robots = scene_->world().robots.size();
    if (message.to && message.to->index() >= robots) {
      return Error{{}, fmt::format("sends a message to robot {}, expected one of {}", message.to->index(), robots)};
    }
  }
  return {};
}

void Robot::ChangeWorld(const Scene& scene) {
  scene_ = &scene;
  manipulator_.ChangeWorld(scene.world());
}

const RobotDescription& Robot::description() const {
  return scene_->world().robot(id_);
}

RobotInfo Robot::Info() const {
  const WorldDescription& world = scene_->world();
  RobotInfo info = InfoInWorld(world, id_, manipulator_, scene_->lights_of(id_));
  for (std::size_t i = 0; i < world.doors.size(); ++i) {
    const Pose& X_WD = scene_->X_LM(world.doors[i].model);
    info.doors[i].middle = X_WD.translation();
    info.doors[i].z = X_WD.z;
    info.doors[i].sweeps = SweepsOf(world, world.doors[i]);
  }
  for (std::size_t i = 0; i < world.lifts.size(); ++i) {
    info.lifts[i].middle = scene_->X_LM(world.lifts[i].model).translation();
  }
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const SensorDescription& sensor = sensors_.sensor(i).description();
    info.sensors.push_back({&sensor, scene_->X_RM(sensor.model)});
  }
  return info;
}

Status Robot::StartController(const AllowedPaths& libraries) {
  Result<std::unique_ptr<Controller>> controller = CreateController(Info(), libraries);
  if (!controller.ok()) return controller.error();
  controller_ = std::move(controller).value();
  watcher_ = dynamic_cast<RobotWatcher*>(controller_.get());
  return Subscribe();
}

Status Robot::Subscribe() {
  const std::string& name = description().controller.name;
  try {
    for (const std::size_t sensor : controller_->Subscriptions()) {
      if (sensor >= sensors_.size()) {
        return Error{
            {},
            fmt::format("controller {} subscribes to sensor {}, but the robot has {}", name, sensor, sensors_.size())};
      }
      sensors_.Subscribe(sensor);
    }
    accepts_goals_ = controller_->AcceptsGoals();
  } catch (const std::exception& exception) {
    return Error{{}, fmt::format("controller {}: {}", name, exception.what())};
  } catch (...) {
    return Error{{}, fmt::format("controller {} threw something that is not a std::exception", name)};
  }
  return {};
}

Proposal Robot::Decide(const WorldState& state, const BodyIndex& bodies, const ExternalCommand& external,
                       TraceLane* trace) {
  Enter(trace, TickPhase::kSense, state.tick + 1, id_);
  Sense(state, bodies);
  if (scan_log_ != nullptr) LogReadings(state, bodies);
  Enter(trace, TickPhase::kDecide, state.tick + 1, id_);
  return Propose(state, bodies, external);
}

Proposal Robot::Retrace(const WorldState& state, const BodyIndex& bodies, const ExternalCommand& external) {
  Sense(state, bodies);
  return Propose(state, bodies, external);
}

void Robot::Prefetch() const {
  troupe::Prefetch(this, sizeof *this);
}

void Robot::Sense(const WorldState& state, const BodyIndex& bodies) {
  constexpr std::size_t kControllerBytes = 384;  // about as many as most have
  troupe::Prefetch(controller_.get(), kControllerBytes);
  sensors_.Prefetch();
  odometry_.Update(state.robots[id_.index()].X_WR);
  sensors_.Update({*scene_, bodies, &state}, state.tick);
}

Proposal Robot::Propose(const WorldState& state, const BodyIndex& bodies, const ExternalCommand& external) {
  const RobotState& own = state.robots[id_.index()];
  manipulator_.Update(state, sensors_.readings());
  report_.clear();
  // Called also while an external command overrides it: a controller sees every tick.
  // After a failure the robot stands still for the rest of the run: a controller that threw has an unknown state.
  Command command = failure_.empty() ? AskController(state, bodies, external) : Command{};
  std::vector<RadioMessage> messages = std::move(command.messages);
  messages.insert(messages.end(), external.command.messages.begin(), external.command.messages.end());
  // The external orders come last, so that they win where one order replaces another.
  std::vector<Order> orders;
  for (const Command* const source : {static_cast<const Command*>(&command), &external.command}) {
    for (const Order& order : source->orders) orders.push_back(WithinLimits(scene_->world(), id_, order));
  }
  std::string say = PlainLine(external.command.say.empty() ? command.say : external.command.say, kMaxSaidBytes);
  std::vector<FleetMessage> fleet = std::move(command.fleet);
  if (external.drives) command = external.command;
  // After the controller's commands: an external one overrides them.
  static_cast<void>(manipulator_.Apply(external.command));  // valid: ExternalCommand requires it
  const Twist twist = DriveTowards(description().drive, own.twist, command, scene_->world().interval_seconds());
  // After a failure the joints stay, and grippers keep their objects.
  return {id_,
          twist,
          failure_.empty() ? manipulator_.Propose(state) : std::vector<double>{},
          WithinLimits(description(), scene_->world().interval_seconds(), std::move(messages)),
          ByKind(std::move(orders)),
          std::move(say),
          std::move(fleet)};
}

const SensorReading& Robot::Measure(std::size_t sensor, const WorldState& state, const BodyIndex& bodies) {
  return sensors_.Measure(sensor, {*scene_, bodies, &state}, state.tick);
}

// Sensors without a subscription are measured for the log alone: the controller decides the same with and without it.
void Robot::LogReadings(const WorldState& state, const BodyIndex& bodies) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const Sensor& sensor = sensors_.sensor(i);
    if (sensor.IsDueAt(state.tick)) scan_log_->Write(sensor.JsonLines(scene_->world(), Measure(i, state, bodies)));
  }
}

const Goal* Robot::EstimatedGoal(const std::optional<Goal>& goal, const Pose& X_WR) {
  if (!goal || !accepts_goals_) {
    goal_.reset();
    return nullptr;
  }
  // Converted once, when the goal arrives: the robot keeps it in the frame of its estimate, as a real robot would.
  if (goal_ && goal_->number == goal->number) return &*goal_;
  goal_ = goal;
  const Pose& estimate = odometry_.estimate();
  if (estimate == X_WR) return &*goal_;
  // X_EW, of the world in the frame of the estimate.
  const Pose X_EW = estimate * Inverse(X_WR);
  const Transform2 transform(X_EW);
  for (Vec2& point : goal_->waypoints) point = transform * point;
  for (double& z : goal_->heights) z += X_EW.z;
  if (goal_->heading) goal_->heading = WrapAngle(*goal_->heading + X_EW.heading);
  return &*goal_;
}

Command Robot::AskController(const WorldState& state, const BodyIndex& bodies, const ExternalCommand& external) {
  const WorldDescription& world = scene_->world();
  const RobotState& own = state.robots[id_.index()];
  Observation observation;
  observation.tick = state.tick;
  observation.time = TimeOf(world, state.tick);
  observation.interval = world.interval_seconds();
  observation.pose_estimate = odometry_.estimate();
  observation.twist = own.twist;
  observation.stalled = own.stalled;
  observation.sensors = sensors_.readings();
  observation.joints = manipulator_.joint_readings();
  observation.grippers = manipulator_.gripper_readings();
  // In most worlds there is none, and the robots of a swarm have no room for the models of all in a cache.
  const std::optional<std::size_t> store =
      scene_->stores().empty() ? std::nullopt : scene_->store_of(description().root);
  if (store) {
    const PowerDescription& power = world.model(scene_->stores()[*store].model).power;
    observation.energy = {state.stores[*store].joules, power.capacity, state.stores[*store].charge_watts};
  }
  const std::size_t first_light = scene_->first_light_of(id_);
  for (std::size_t i = 0; i < scene_->lights_of(id_).size(); ++i) {
    observation.lights.push_back(state.lights[first_light + i].is_switched_on);
  }
  observation.doors = state.doors;
  observation.lifts = state.lifts;
  // By tick, not by a running generator: a controller that is started late or copied draws the same numbers.
  observation.random_key = RandomBits({kControllerStream, world.seed, id_.index(), state.tick});
  observation.goal = EstimatedGoal(external.goal, own.X_WR);
  observation.fleet = external.fleet;
  observation.is_overridden = external.drives;
  if (watcher_ != nullptr) watcher_->WatchRobots({*scene_, bodies, state});
  Result<Command> command = RunController(observation);
  if (command.ok()) {
    StoreReport(command.value().report);
    return std::move(command).value();
  }
  failure_ = fmt::format("robot {}: controller {} failed at tick {}: {}", description().name,
                         description().controller.name, state.tick, command.error().message);
  return {};
}

void Robot::StoreReport(const std::string& text) {
  if (text.empty()) return;
  report_ = fmt::format("robot {}: {}", description().name, PlainLine(text, kMaxReport));
}

Result<Command> Robot::RunController(const Observation& observation) {
  try {
    Command command = controller_->Update(observation);
    if (const Status status = manipulator_.Apply(command); !status.ok()) return status.error();
    if (const Status status = CheckOrders(command); !status.ok()) return status.error();
    return command;
  } catch (const std::exception& exception) {
    return Error{{}, exception.what()};
  } catch (...) {
    return Error{{}, "threw something that is not a std::exception"};
  }
}

void AddCommand(const RobotCommand& added, const DriveDescription& drive, ExternalCommand& external) {
  if (added.twist) {
    const Command motion = CommandFromTwist(*added.twist, drive);
    external.command.twist = motion.twist;
    external.command.speed = motion.speed;
    external.command.steering = motion.steering;
    external.drives = true;
  }
  for (const GripperOrder& order : added.grippers) {
    external.command.grippers.push_back({.gripper = order.gripper, .lift = order.lift, .opening = order.opening});
  }
  external.goal = added.goal;
  external.fleet = added.messages;
}

Result<std::unique_ptr<ScanLog>> ScanLog::Open(const std::string& path, bool keep) {
  const Result<off_t> kept = keep ? LengthOfWholeLines(path) : Result<off_t>(0);
  if (!kept.ok()) return kept.error();
  Result<FileDescriptor> file = OpenToWrite(path, kept.value() == 0 ? O_TRUNC : 0);
  if (!file.ok()) return Error{{path}, "cannot write scans here: " + file.error().message, ErrorCode::kOutputFailed};
  const int descriptor = file.value().get();
  std::FILE* stream = nullptr;
  if (kept.value() == 0 ||
      (ftruncate(descriptor, kept.value()) == 0 && lseek(descriptor, kept.value(), SEEK_SET) == kept.value())) {
    stream = fdopen(descriptor, "w");
  }
  // The descriptor still closes the file here.
  if (stream == nullptr) {
    return SystemError("cannot write scans here", path, ErrorCode::kOutputFailed);
  }
  (void)file.value().Release();  // the stream closes it
  return std::unique_ptr<ScanLog>(new ScanLog(stream, path));
}

ScanLog::~ScanLog() {
  std::fclose(file_);
}

void ScanLog::Write(const std::string& lines) {
  if (muted_) return;
  if (status_.ok() && std::fwrite(lines.data(), 1, lines.size(), file_) != lines.size()) Fail();
}

void ScanLog::Restart(std::uint32_t edition) {
  Write("{\"edition\":" + std::to_string(edition) + "}\n");
}

Status ScanLog::Flush() {
  if (status_.ok() && std::fflush(file_) != 0) Fail();
  return status_;
}

void ScanLog::Fail() {
  status_ = SystemError("cannot write scans", path_, ErrorCode::kOutputFailed);
  __fpurge(file_);  // a later attempt might write text behind a gap
}

}  // namespace troupe
