// Robot: one simulated robot inside its agent: sensors, odometry, controller, drive and gripper around a shared
// replica.
//
// A tick is: odometry and the due sensors follow the state (Sense), the controller decides, its commands are checked
// and turned into a proposal within the limits of the drive, the joints and the radios (Propose). The controller is the
// only part of a user: its exceptions and invalid commands are caught, reported once, and leave the robot standing with
// its objects held, while the run continues.
//
// Memory: odometry, the last readings of sensors with a period, the commands to grippers and joints, and the controller
// itself. All else is in the world's state. Relocate and ChangeWorld bring this memory through edits.
//
// Threads: one at a time for one robot; different robots at the same time, each call with a BodyIndex of its thread.
#pragma once

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "common/model/proposal.h"
#include "common/sensing/sensor_suite.h"
#include "robot-agent/drive/drive.h"
#include "robot-agent/gripper/manipulator.h"
#include "troupe/controller.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"
#include "troupe/world_state.h"

namespace troupe {

// A command from outside of the simulation for one robot and tick.

struct ExternalCommand {
  // Commands to grippers, joints and radios are applied after the controller's. REQUIRES: they are valid for the robot.
  Command command = {};
  bool drives = false;                   // the motion in `command` overrides the controller's
  std::optional<Goal> goal = {};         // for a controller that accepts goals
  std::vector<FleetMessage> fleet = {};  // of its fleet control, for the controller
};

// Adds a command of a frame, whose motion overrides one that is there. REQUIRES: CheckRobotCommand succeeded.
void AddCommand(const RobotCommand& added, const DriveDescription& drive, ExternalCommand& external);

class BodyIndex;
class RobotWatcher;
class Scene;
class ScanLog;
class TraceLane;

struct RobotOptions {
  ScanLog* scan_log = nullptr;  // not null: all sensors are measured and written there
  AllowedPaths libraries = {};  // that may be a robot's controller
};

class Robot {
 public:
  // The scene must outlive the robot.
  static Result<std::unique_ptr<Robot>> Create(const Scene& scene, RobotId id, const RobotOptions& options = {});

  // A robot that continues as this one would, in the same scene and without a scan log. The error is a controller that
  // cannot be copied.
  Result<std::unique_ptr<Robot>> Clone() const;

  // Continues in an edited world that has the robot with the same ids and the same description.
  // REQUIRES: the scene of Create still exists.
  void ChangeWorld(const Scene& scene);

  // Fetches its memory, for a Decide soon (common/base/prefetch.h).
  void Prefetch() const;

  RobotId id() const { return id_; }

  // The knowledge of its controller about it before the first tick.
  RobotInfo Info() const;

  // Measures state n, calls the controller, and returns the proposal for tick n + 1. Called once for each
  // tick, in order; ticks may be missing after an absence of the agent. `trace` may be null.
  Proposal Decide(const WorldState& state, const BodyIndex& bodies, const ExternalCommand& external = {},
                  TraceLane* trace = nullptr);

  // As Decide, for a state of the past, so that the robot remembers it: without scan log.
  Proposal Retrace(const WorldState& state, const BodyIndex& bodies, const ExternalCommand& external = {});

  // The error is a command to a gripper, a joint, a radio, a light or a camera that the robot cannot execute; nothing
  // is changed.
  Status CheckCommand(const Command& command) const;

  // Applies the pose that an edit has given to the robot: odometry does not count it as a motion.
  void Relocate(const WorldState& state) { odometry_.Relocate(state.robots[id_.index()].X_WR); }
  // Applies a state without a decision.
  void UpdateOdometry(const WorldState& state) { odometry_.Update(state.robots[id_.index()].X_WR); }

  const Pose& pose_estimate() const { return odometry_.estimate(); }

  // The reading of a sensor in a state, which `bodies` holds, with or without a subscription of the controller. Valid
  // until the next call of this or of Decide.
  // REQUIRES: `sensor` < sensor_count(); the state is that of the last Decide, or of another tick.
  const SensorReading& Measure(std::size_t sensor, const WorldState& state, const BodyIndex& bodies);
  std::size_t sensor_count() const { return sensors_.size(); }

  // Its controller does.
  bool accepts_goals() const { return accepts_goals_; }

  // What the controller reported in the last Decide, on one line that names the robot; empty: nothing.
  const std::string& report() const { return report_; }

  // The failure of the controller; empty while it works. After a failure the robot stands still.
  const std::string& failure() const { return failure_; }

 private:
  Robot(const Scene& scene, RobotId id, ScanLog* scan_log);

  const RobotDescription& description() const;
  // What needs no manipulator.
  Status CheckOrders(const Command& command) const;
  Status CheckReceivers(const Command& command) const;  // of its radio messages
  // Makes the controller and subscribes to its sensors.
  Status StartController(const AllowedPaths& libraries);
  Status Subscribe();
  void Sense(const WorldState& state, const BodyIndex& bodies);
  void LogReadings(const WorldState& state, const BodyIndex& bodies);
  // Decides with the readings of Sense.
  Proposal Propose(const WorldState& state, const BodyIndex& bodies, const ExternalCommand& external);
  // Stores the controller's failure, if it fails.
  Command AskController(const WorldState& state, const BodyIndex& bodies, const ExternalCommand& external);
  // The goal in the frame of the pose estimate: fixed there when it arrives, so that a drift of odometry does not move
  // it for the controller.
  const Goal* EstimatedGoal(const std::optional<Goal>& goal, const Pose& X_WR);
  Result<Command> RunController(const Observation& observation);
  void StoreReport(const std::string& text);

  const Scene* scene_;
  RobotId id_;
  ScanLog* scan_log_;
  std::unique_ptr<Controller> controller_;
  RobotWatcher* watcher_ = nullptr;  // the controller, if it watches other bodies
  Odometry odometry_;
  Manipulator manipulator_;
  SensorSuite sensors_;
  bool accepts_goals_ = false;
  std::optional<Goal> goal_;  // in the frame of the pose estimate
  std::string failure_;
  std::string report_;
};

// ScanLog: a file of JSON lines, one or more for each reading of each sensor (Sensor::JsonLines), in the order of
// ticks, robots and sensors. A ranger writes {"tick","robot","sensor","ranges"} for each ray sensor.
class ScanLog {
 public:
  ~ScanLog();
  ScanLog(const ScanLog&) = delete;
  ScanLog& operator=(const ScanLog&) = delete;

  // With `keep` new lines follow the lines of the file; a last line without its end, as a killed agent leaves, is
  // removed.
  static Result<std::unique_ptr<ScanLog>> Open(const std::string& path, bool keep = false);

  // Appends lines, each with its line end.
  void Write(const std::string& lines);

  // Marks a restart of the robots, perhaps at an earlier tick: writes {"edition":N}.
  void Restart(std::uint32_t edition);

  // While it is muted, nothing is written.
  void Mute(bool muted) { muted_ = muted; }

  // The first error of a write (a full disk); nothing is written after it.
  const Status& status() const { return status_; }
  // Writes all buffered lines to the file.
  Status Flush();

 private:
  explicit ScanLog(std::FILE* file, std::string path) : file_(file), path_(std::move(path)) {}
  void Fail();

  std::FILE* file_;
  std::string path_;
  Status status_;
  bool muted_ = false;
};

}  // namespace troupe
