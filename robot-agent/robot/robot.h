// Robot: one simulated robot inside its agent: sensors, odometry, controller, drive and gripper around a shared
// replica.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/allowed_paths.h"
#include "common/model/proposal.h"
#include "common/sensing/sensor_suite.h"
#include "robot-agent/drive/drive.h"
#include "robot-agent/gripper/manipulator.h"
#include "robot-agent/robot/external_command.h"
#include "troupe/controller.h"
#include "troupe/result.h"
#include "troupe/world_state.h"

namespace troupe {

class BodyIndex;
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

  RobotId id() const { return id_; }

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
  Status CheckReceivers(const Command& command) const;  // of its radio messages
  Status CheckLights(const Command& command) const;
  Status CheckCameras(const Command& command) const;
  // Makes the controller and subscribes to its sensors.
  Status StartController(const AllowedPaths& libraries);
  Status Subscribe();
  void Sense(const WorldState& state, const BodyIndex& bodies);
  void LogReadings(const WorldState& state, const BodyIndex& bodies);
  // Decides with the readings of Sense.
  Proposal Propose(const WorldState& state, const ExternalCommand& external);
  // Stores the controller's failure, if it fails.
  Command AskController(const WorldState& state, const std::optional<Goal>& goal);
  // The goal in the frame of the pose estimate: fixed there when it arrives, so that a drift of odometry does not move
  // it for the controller.
  const Goal* EstimatedGoal(const std::optional<Goal>& goal, const Pose& X_WR);
  Result<Command> RunController(const Observation& observation);
  void StoreReport(const std::string& text);

  const Scene* scene_;
  RobotId id_;
  ScanLog* scan_log_;
  std::unique_ptr<Controller> controller_;
  Odometry odometry_;
  Manipulator manipulator_;
  SensorSuite sensors_;
  bool accepts_goals_ = false;
  std::optional<Goal> goal_;  // in the frame of the pose estimate
  std::string failure_;
  std::string report_;
};

}  // namespace troupe
