// Simulation: a run in one process, without a network. Robots decide in the order of their ids and the core steps, with
// the code of the distributed run (Robot, ValidateProposal, Step): so the state hashes are those of `troupe run` of the
// same file.
//
// A snapshot owns copies of the controllers and shares the immutable scene and state. Every copy of robots points into
// the scene, which therefore lives as long as any of them (Snapshot::Content).

#include "troupe/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "common/model/proposal.h"
#include "common/model/states.h"
#include "common/spatial/body_index.h"
#include "common/spatial/check_order.h"
#include "common/spatial/occupancy_grid.h"
#include "common/spatial/scene.h"
#include "library/save_picture.h"
#include "library/simulation_content.h"
#include "robot-agent/controller/create_controller.h"
#include "robot-agent/drive/drive.h"
#include "robot-agent/robot/robot.h"
#include "testing/expectations/tick_view.h"
#include "troupe/event.h"
#include "troupe/world_state.h"
#include "world-service/core/step.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

Result<std::vector<std::unique_ptr<Robot>>> CreateRobots(const Scene& scene) {
  std::vector<std::unique_ptr<Robot>> robots;
  for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
    Result<std::unique_ptr<Robot>> robot = Robot::Create(scene, RobotId(i), {nullptr, AllowedPaths::All()});
    if (!robot.ok()) return robot.error();
    robots.push_back(std::move(robot).value());
  }
  return robots;
}

}  // namespace

Simulation::Impl::Impl(Snapshot::Content start) : now(std::move(start)), bodies(*now.scene) {
  bodies.Assign(*now.state);
}

void Simulation::Impl::Assign(Snapshot::Content content) {
  const bool same_scene = content.scene == now.scene;
  now = std::move(content);
  // Otherwise the index only moves what differs between the two states.
  if (!same_scene) bodies = BodyIndex(*now.scene);
  bodies.Assign(*now.state);
}

Simulation::Simulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Simulation::Simulation(Simulation&& other) noexcept = default;
Simulation& Simulation::operator=(Simulation&& other) noexcept = default;
Simulation::~Simulation() = default;

Result<Simulation> Simulation::Load(const std::string& file, const SimulationOptions& options) {
  return LoadFrom({file}, options);
}

Result<Simulation> Simulation::LoadScenario(const std::string& text, const std::string& path,
                                            const SimulationOptions& options) {
  return LoadFrom({path, text}, options);
}

Result<Simulation> Simulation::LoadFrom(WorldSource source, const SimulationOptions& options) {
  LoadOverrides overrides;
  overrides.seed = options.seed;
  overrides.controller = options.controller;
  if (options.run_controllers) overrides.check_controller = CheckController;
  if (options.run_controllers) overrides.check_in_world = CheckControllerNeeds;
  Result<LoadedWorld> loaded = LoadWorld(source, overrides);
  if (!loaded.ok()) return loaded.error();
  Result<Simulation> simulation = Make(std::move(loaded.value().world), options);
  if (!simulation.ok()) return simulation;
  Impl& impl = *simulation.value().impl_;
  impl.warnings = std::move(loaded.value().warnings);
  impl.now.origin = std::make_shared<const SimulationOrigin>(
      SimulationOrigin{std::move(source), options.controller, options.run_controllers});
  return simulation;
}

Result<Simulation> Simulation::Create(WorldDescription world, const SimulationOptions& options) {
  if (const Status problem = Validate(world); !problem.ok()) return problem.error();
  return Make(std::move(world), options);
}

Result<Simulation> Simulation::Make(WorldDescription world, const SimulationOptions& options) {
  if (!options.run_controllers) {
    for (RobotDescription& robot : world.robots) robot.controller = {};
  }
  auto scene = std::make_shared<Scene>(std::move(world));
  if (options.share_with != nullptr) {
    const std::shared_ptr<const Scene>& other = options.share_with->impl_->now.scene;
    scene->ShareMap([&](std::span<const std::byte> bytes) -> std::shared_ptr<const std::byte> {
      const std::span<const std::byte> shared = other->static_index().ray_map().bytes();
      // Compared and not assumed: worlds of one file may differ by their seeds.
      if (!std::equal(bytes.begin(), bytes.end(), shared.begin(), shared.end())) return nullptr;
      return {other, shared.data()};
    });
  }
  return AtState(scene, std::make_shared<const WorldState>(InitialState(*scene)), {});
}

Result<Simulation> Simulation::AtState(const std::shared_ptr<const Scene>& scene,
                                       std::shared_ptr<const WorldState> state, std::vector<Event> events) {
  Result<std::vector<std::unique_ptr<Robot>>> robots = CreateRobots(*scene);
  if (!robots.ok()) return robots.error();
  Snapshot::Content start;
  start.origin = std::make_shared<const SimulationOrigin>();
  start.robot_scenes.push_back(scene);
  start.scene = scene;
  start.state = std::move(state);
  start.events = std::move(events);
  start.robots = std::move(robots).value();
  start.commands.resize(start.robots.size());
  return Simulation(std::make_unique<Impl>(std::move(start)));
}

const WorldDescription& Simulation::world() const {
  return impl_->now.scene->world();
}

std::optional<RobotId> Simulation::FindRobot(const std::string& name) const {
  return troupe::FindRobot(world(), name);
}

const std::vector<Warning>& Simulation::warnings() const {
  return impl_->warnings;
}

void Simulation::Step(Tick ticks) {
  impl_->reports.clear();
  impl_->fleet_outputs.clear();
  for (Tick i = 0; i < ticks; ++i) StepOnce();
}

void Simulation::StepOnce() {
  Snapshot::Content& now = impl_->now;
  const WorldState& state = *now.state;
  std::vector<Event> events;
  impl_->proposals.clear();
  for (std::size_t i = 0; i < now.robots.size(); ++i) {
    Robot& robot = *now.robots[i];
    if (!RobotExists(world(), robot.id())) continue;
    const bool worked = robot.failure().empty();
    Proposal proposal = robot.Decide(state, impl_->bodies, now.commands[i]);
    // The motion lasts until another command; all else of a command is executed once.
    Command& given = now.commands[i].command;
    now.commands[i].fleet.clear();
    if (now.commands[i].drives) given = {.twist = given.twist, .speed = given.speed, .steering = given.steering};
    if (worked && !robot.failure().empty()) now.failures.push_back(robot.failure());
    if (!robot.report().empty()) impl_->reports.push_back(robot.report());
    // As the world service does it: a refused proposal is an event, and the step has none of that robot.
    const Status status = ValidateProposal(*now.scene, state, proposal);
    if (status.ok()) {
      for (const FleetMessage& message : proposal.fleet) {
        impl_->fleet_outputs.push_back({robot.id(), state.tick + 1, message});
      }
      impl_->proposals.push_back(std::move(proposal));
    } else {
      events.push_back({.tick = state.tick + 1,
                        .type = EventType::kProposalRejected,
                        .robot = robot.id(),
                        .detail = status.error().message});
    }
    const auto report = [&](const std::string& line) {  // that begins with "robot NAME: "
      const std::size_t name = std::string_view("robot : ").size() + world().robot(robot.id()).name.size();
      events.push_back({.tick = state.tick + 1,
                        .type = EventType::kReported,
                        .robot = robot.id(),
                        .detail = PlainLine(std::string_view(line).substr(name))});
    };
    if (worked && !robot.failure().empty()) report(robot.failure());
    if (!robot.report().empty()) report(robot.report());
  }
  // All robots have decided by the state before the step: none sees another's new pose.
  impl_->inputs = ByKind(std::exchange(now.inputs, {}));
  StepResult next = troupe::Step(*now.scene, state, impl_->proposals, impl_->bodies, nullptr, impl_->inputs);
  // A new object for each tick: arrays of Python and snapshots keep the states that they show.
  now.state = std::make_shared<const WorldState>(std::move(next.state));
  now.events = std::move(events);
  now.events.insert(now.events.end(), std::make_move_iterator(next.events.begin()),
                    std::make_move_iterator(next.events.end()));
  impl_->bodies.Assign(*now.state);
}

double Simulation::time() const {
  return static_cast<double>(tick()) * static_cast<double>(world().interval_ns) / 1e9;
}

const WorldState& Simulation::state() const {
  return *impl_->now.state;
}

std::shared_ptr<const WorldState> Simulation::shared_state() const {
  return impl_->now.state;
}

std::shared_ptr<const Scene> Simulation::scene() const {
  return impl_->now.scene;
}

std::uint64_t Simulation::state_hash() const {
  return StateHash(state());
}

const std::vector<Event>& Simulation::events() const {
  return impl_->now.events;
}

const std::vector<std::string>& Simulation::failures() const {
  return impl_->now.failures;
}

const std::vector<std::string>& Simulation::reports() const {
  return impl_->reports;
}

const std::vector<Simulation::FleetOutput>& Simulation::fleet_outputs() const {
  return impl_->fleet_outputs;
}

RobotInfo Simulation::Info(RobotId robot) const {
  return impl_->now.robots[robot.index()]->Info();
}

const Pose& Simulation::pose(RobotId robot) const {
  return state().robots[robot.index()].X_WR;
}

std::vector<std::optional<ModelId>> Simulation::HeldObjects(RobotId robot) const {
  std::vector<std::optional<ModelId>> held;
  for (const GripperId gripper : impl_->now.scene->grippers_of(robot)) {
    const std::optional<ObjectId> object = state().grippers[gripper.index()].clamped;
    const bool holds = object && state().objects[object->index()].holder == gripper;
    held.push_back(holds ? std::optional(world().objects[object->index()]) : std::nullopt);
  }
  return held;
}

SensorReading Simulation::Measure(RobotId robot, std::size_t sensor) const {
  return Read(robot, sensor);
}

const SensorReading& Simulation::Read(RobotId robot, std::size_t sensor) const {
  return impl_->now.robots[robot.index()]->Measure(sensor, state(), impl_->bodies);
}

TickView Simulation::View() const {
  return {*impl_->now.scene, impl_->bodies, state(), events()};
}

Status Monitor::Push(const Simulation& simulation) {
  return Push(simulation.View());
}

Status MetricMonitor::Push(const Simulation& simulation) {
  return Push(simulation.View());
}

Status Simulation::Drive(RobotId robot, Command command) {
  if (!IsFinite(command.twist) || !std::isfinite(command.speed) || !std::isfinite(command.steering)) {
    return Error{{}, "robot " + world().robot(robot).name + ": found a motion with a number that is not finite"};
  }
  if (Status problem = impl_->now.robots[robot.index()]->CheckCommand(command); !problem.ok()) return problem;
  impl_->now.commands[robot.index()] = {std::move(command), true};
  return {};
}

Status Simulation::DriveBy(RobotId robot, const Twist& twist) {
  if (!IsFinite(twist)) {
    return Error{{}, "robot " + world().robot(robot).name + ": found a motion with a number that is not finite"};
  }
  ExternalCommand& external = impl_->now.commands[robot.index()];
  const Command motion = CommandFromTwist(twist, world().robot(robot).drive);
  external.command.twist = motion.twist;
  external.command.speed = motion.speed;
  external.command.steering = motion.steering;
  external.drives = true;
  return {};
}

void Simulation::Release(RobotId robot) {
  impl_->now.commands[robot.index()] = {};
}

Result<OccupancyGrid> Simulation::MakeMap(std::optional<double> resolution, std::optional<double> z) const {
  if (resolution && !(std::isfinite(*resolution) && *resolution > 0.0)) {
    return BadInput("found a resolution of " + std::to_string(*resolution) + ", expected more than 0");
  }
  if (z && !std::isfinite(*z)) return BadInput("found a height that is not finite");
  const Scene& scene = *impl_->now.scene;
  return MakeOccupancyGrid(scene, resolution, z.value_or(UsualMapHeight(scene)));
}

Result<std::string> Simulation::DrawPicture(const PictureOptions& options, PictureRays rays) const {
  return troupe::DrawPicture(*impl_->now.scene, impl_->bodies, state(), options, rays);
}

Status Simulation::SavePicture(const std::string& file, const PictureOptions& options, PictureRays rays) const {
  return troupe::SavePicture(*impl_->now.scene, impl_->bodies, state(), file, options, rays);
}

Status Simulation::SaveView(const std::string& file, RobotId robot, std::size_t sensor, CameraImage image) const {
  const SensorReading reading = Measure(robot, sensor);
  const CameraReading* const view = reading.As<CameraReading>();
  if (view == nullptr) {
    return Error{{}, "found a sensor that is no camera, expected a camera", ErrorCode::kBadInput};
  }
  return troupe::SaveView(*view, file, image);
}

Tick Snapshot::tick() const {
  return content_->state->tick;
}

Result<Snapshot::Content> Snapshot::Content::Copy() const {
  Content copy{origin, robot_scenes, scene, state, events, {}, commands, inputs, goals, failures};
  copy.robots.reserve(robots.size());
  for (const std::unique_ptr<Robot>& robot : robots) {
    Result<std::unique_ptr<Robot>> clone = robot->Clone();
    if (!clone.ok()) return clone.error();
    copy.robots.push_back(std::move(clone).value());
  }
  return copy;
}

Result<Snapshot> Simulation::Save() const {
  Result<Snapshot::Content> copy = impl_->now.Copy();
  if (!copy.ok()) return copy.error();
  return Snapshot(std::make_shared<const Snapshot::Content>(std::move(copy).value()));
}

Result<Simulation> Simulation::Continue(const Snapshot& snapshot) {
  Result<Snapshot::Content> copy = snapshot.content_->Copy();
  if (!copy.ok()) return copy.error();
  return Simulation(std::make_unique<Impl>(std::move(copy).value()));
}

Status Simulation::Restore(const Snapshot& snapshot) {
  Result<Snapshot::Content> copy = snapshot.content_->Copy();
  if (!copy.ok()) return copy.error();
  impl_->Assign(std::move(copy).value());
  return {};
}

}  // namespace troupe
