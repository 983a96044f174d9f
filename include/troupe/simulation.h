// Simulation: a world in one process. Load a file, step, read the state and any sensor, drive robots, save and restore
// snapshots, save pictures. docs/library.md is a tour.
//
// The robots decide and the step moves them by the same code as in a distributed run, so that after the same number of
// ticks the state hash is that of `troupe run` of the same file in lockstep, over any number of processes.
//
// Threads: a simulation has none of its own. One simulation is for one thread at a time; several are independent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/controller.h"
#include "troupe/event.h"
#include "troupe/ids.h"
#include "troupe/occupancy_grid.h"
#include "troupe/order.h"
#include "troupe/picture_options.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"
#include "troupe/sensor.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

class Scene;
class Simulation;
struct EditedWorld;  // world-service/core/edit_world.h
struct TickView;     // testing/expectations/tick_view.h
struct WorldSource;  // worldfile/load_world.h

struct SimulationOptions {
  std::optional<std::uint64_t> seed;      // of all random numbers; nothing: the file's
  std::optional<std::string> controller;  // for robots to which the file gives none; nothing: "idle"
  // False: no robot has its controller; each stands still until it is driven.
  bool run_controllers = true;
  // A simulation whose memory for the static map the new one shares, if the maps are equal; null: none.
  const Simulation* share_with = nullptr;
};

enum class PictureRays : std::uint8_t {
  kHidden,
  kDrawn,  // the readings of all sensors
};

enum class CameraImage : std::uint8_t {
  kColors,
  kDepths,  // grey: white at the nearest limit, black at the farthest
};

// The whole of a simulation at one tick: the world's state, and for each robot its controller, its odometry, the
// commands to its grippers and joints, and the last readings of its sensors. A value: copies share constant data.
class Snapshot {
 public:
  Tick tick() const;

 private:
  friend class Simulation;
  friend class SnapshotBytes;
  struct Content;
  explicit Snapshot(std::shared_ptr<const Content> content) : content_(std::move(content)) {}

  std::shared_ptr<const Content> content_;  // never null
};

class Simulation {
 public:
  // Loads a Stage world (.world), a scenario (.json) or a ROS map (.yaml). The error names the place in the file, or
  // the controller that cannot be made.
  static Result<Simulation> Load(const std::string& file, const SimulationOptions& options = {});
  // The same for the text of a scenario. `path` names it in messages, and paths in it start at that file's folder.
  static Result<Simulation> LoadScenario(const std::string& text, const std::string& path,
                                         const SimulationOptions& options = {});
  // The same for a world that was built in memory; `options.seed` and `options.controller` do not count. The error is a
  // description that is not valid, or a controller that cannot be made.
  static Result<Simulation> Create(WorldDescription world, const SimulationOptions& options = {});

  Simulation(Simulation&& other) noexcept;
  Simulation& operator=(Simulation&& other) noexcept;
  ~Simulation();

  // Constant, until a snapshot is restored or an entity changes.
  const WorldDescription& world() const;
  std::optional<RobotId> FindRobot(const std::string& name) const;
  // What the file's author should know; in the order of the file.
  const std::vector<Warning>& warnings() const;

  // Advances by `ticks` ticks of world().interval_seconds() each: every robot decides, then all move.
  void Step(Tick ticks = 1);

  Tick tick() const { return state().tick; }
  double time() const;              // s, simulated
  const WorldState& state() const;  // valid until the next Step or Restore
  // The same state to keep: it never changes.
  std::shared_ptr<const WorldState> shared_state() const;
  std::uint64_t state_hash() const;
  // The events of the last tick: rejected proposals and reports, then the events of the step. Empty at tick 0.
  const std::vector<Event>& events() const;
  // One line for each controller that has failed so far; its robot stands still from then on.
  const std::vector<std::string>& failures() const;
  // What controllers have reported (Command::report) since the last call of Step began; each line names its robot.
  const std::vector<std::string>& reports() const;
  // What robots have told their fleet control since then (Command::fleet).
  struct FleetOutput {
    RobotId robot;
    Tick tick = 0;
    FleetMessage message;
  };
  const std::vector<FleetOutput>& fleet_outputs() const;

  // The robot's sensors, joints and grippers, in the order in which the functions below count them; valid until a
  // snapshot is restored. REQUIRES: the id is of this world, here and below.
  RobotInfo Info(RobotId robot) const;
  // The robot's pose in the world.
  const Pose& pose(RobotId robot) const;
  // The model that each gripper of the robot holds, in the order of RobotInfo::grippers.
  std::vector<std::optional<ModelId>> HeldObjects(RobotId robot) const;
  // The reading of one of the robot's sensors, by its place in RobotInfo::sensors, in the present state. Whether it is
  // read changes nothing. REQUIRES: the sensor exists.
  SensorReading Measure(RobotId robot, std::size_t sensor) const;
  // The same without a copy: valid until the next call of this, Measure, Step or Restore.
  const SensorReading& Read(RobotId robot, std::size_t sensor) const;

  // The present tick for monitors (expectation.h), which read it by Monitor::Push. Valid until the next Step or
  // Restore.
  TickView View() const;

  // Drives a robot from outside, from the next tick on. The motion of `command` replaces that of the robot's controller
  // until the next Drive or Release. All else of it is executed once, after the controller's: commands to grippers and
  // joints, messages, orders, and the text to say; `report` has no effect. The error is a number that is not finite, or
  // a command to a gripper or joint that the robot cannot execute.
  Status Drive(RobotId robot, Command command);
  // The same with a motion alone, in R; a car turns its wheels so that it follows the twist as far as it can.
  Status DriveBy(RobotId robot, const Twist& twist);
  // Returns the robot to its controller.
  void Release(RobotId robot);

  // Changes from outside, between two ticks: those of `troupe ctl`, `goto` and the page. The same ones at the same
  // ticks give the hashes of such a run. On an error nothing has changed. Bodies, sensors and events are those of the
  // changed state at once.

  // Sends a robot to the goal, whose number does not count, until the next one. The error is a controller that accepts
  // no goals, or a goal that it cannot reach, with the reason.
  Status SendTo(RobotId robot, Goal goal);
  void CancelGoal(RobotId robot);
  // A message of a fleet control to the robot's controller, for the next tick. The error is one that is too long, or
  // not to a vehicle.
  Status SendMessage(RobotId robot, FleetMessage message);
  // An order to a door, a lift or a light, or a twist, for the next tick.
  Status AddInput(const Input& input);
  // X_WE of an entity: a robot, an object, a person or a static model. The error is an unknown name.
  Result<Pose> FindPose(const std::string& entity) const;
  // Places an entity. What a robot holds falls. The error's code is
  // kNoRoom where something stands, and kBadInput for an unknown name.
  Status SetPose(const std::string& entity, const Pose& X_WE);
  // Adds an entity behind all others, and returns its name: a model of the world's file, or a file with one model, or
  // FILE#NAME. Without `name` it gets a free one. A robot has the controller that it has there, or `controller`. The
  // errors are those of SetPose, a name in use, those of the file, and those of the controller.
  Result<std::string> Spawn(const std::string& source, const Pose& X_WE, const std::string& name = "",
                            const std::optional<ControllerDescription>& controller = {});
  // Removes an entity. It keeps its place in the lists of the world and the state.
  Status Delete(const std::string& entity);

  // The error names a controller that cannot be copied (Controller::Clone).
  Result<Snapshot> Save() const;
  // Continues from `snapshot`, which may be of another simulation, and may be restored any number of times. The same
  // steps from it give the same hashes. On an error, a controller that cannot be copied, nothing has changed.
  Status Restore(const Snapshot& snapshot);

  // A further simulation that continues from `snapshot`, with the constant parts of its world in the same memory.
  // The error is a controller that cannot be copied.
  static Result<Simulation> Continue(const Snapshot& snapshot);

  // The static bodies that reach through height `z` (m), as cells of `resolution` (m). Nothing: the resolution of the
  // world's ROS map or 0.05, and the height of the world's lowest sensor with several rays. At most 16 million cells: a
  // resolution that would give more is doubled until it does not. The error is a number that is not finite, or not
  // positive.
  Result<OccupancyGrid> MakeMap(std::optional<double> resolution = {}, std::optional<double> z = {}) const;

  // Draws the present state: the bytes of a file in options.format. The error's code is kBadInput for options out of
  // bounds.
  Result<std::string> DrawPicture(const PictureOptions& options = {}, PictureRays rays = PictureRays::kHidden) const;
  // Draws the present state; the ending of `file`, .png or .svg, sets the format in place of options.format. The
  // error's code is kBadInput for options out of bounds and kOutputFailed for a file that cannot be written.
  Status SavePicture(const std::string& file, const PictureOptions& options = {},
                     PictureRays rays = PictureRays::kHidden) const;
  // Writes the image of a camera in the present state, a pixel for each of its own, as a .png. The error's code is
  // kBadInput for a sensor that is no camera or another ending, and kFailure for a file that cannot be written.
  Status SaveView(const std::string& file, RobotId robot, std::size_t sensor,
                  CameraImage image = CameraImage::kColors) const;

 private:
  friend class RecordedSimulation;
  friend class SimulationPage;
  friend class SimulationRecorder;
  friend class SnapshotBytes;
  struct Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  static Result<Simulation> Make(WorldDescription world, const SimulationOptions& options);
  static Result<Simulation> LoadFrom(WorldSource source, const SimulationOptions& options);
  static Result<Simulation> AtState(const std::shared_ptr<const Scene>& scene, std::shared_ptr<const WorldState> state,
                                    std::vector<Event> events);
  std::shared_ptr<const Scene> scene() const;
  void StepOnce();
  Status Follow(Result<EditedWorld> edited);

  std::unique_ptr<Impl> impl_;  // null only after a move
};

}  // namespace troupe
