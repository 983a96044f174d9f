// Robot: one simulated robot inside its agent: sensors, odometry, controller and drive around a shared replica.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/model/proposal.h"
#include "common/model/world_state.h"
#include "robot-agent/agent/outside_command.h"
#include "robot-agent/controller/controller.h"
#include "robot-agent/drive/odometry.h"
#include "robot-agent/gripper/manipulator.h"

namespace troupe {

class BodyIndex;
class Scene;
class ScanLog;
class TraceLane;

class Robot {
 public:
  // The scene must outlive the robot. `scan_log` may be null; with one, all rangers are measured and written there.
  static Result<std::unique_ptr<Robot>> Create(const Scene& scene, RobotId id, ScanLog* scan_log);

  // An edit has changed the world around the robot, and left it as it was. The scene that it was made for must still be
  // there.
  void ChangeWorld(const Scene& scene);

  RobotId id() const { return id_; }

  // Senses state n, lets the controller decide, and returns the proposal for tick n + 1. Called once for each tick,
  // in order; ticks may be missing after the agent was away. `trace` may be null.
  Proposal Decide(const WorldState& state, const BodyIndex& bodies, const OutsideCommand& outside = {},
                  TraceLane* trace = nullptr);

  // Takes in where an edit has put the robot.
  void Carry(const WorldState& state) { odometry_.Carry(state.robots[id_.index()].X_WR); }
  // Takes in a state that is not (yet) to be decided on.
  void Observe(const WorldState& state) { odometry_.Update(state.robots[id_.index()].X_WR); }

  const Pose& pose_estimate() const { return odometry_.estimate(); }

  // What a ranger measures in the state of the last Decide, whether the controller looked or not. Valid until the next
  // call of this or of Decide.
  const RangerReading& Measure(std::size_t ranger, Tick tick, const BodyIndex& bodies);

  // Why the controller failed, once it has; then the robot stands still.
  const std::string& failure() const { return failure_; }

 private:
  Robot(const Scene& scene, RobotId id, ScanLog* scan_log);

  const RobotDescription& description() const;
  // Makes the controller and asks for its subscriptions; "" or what went wrong.
  std::string StartController();
  void Sense(Tick tick, const BodyIndex& bodies);
  Command AskController(const WorldState& state);

  const Scene* scene_;
  RobotId id_;
  ScanLog* scan_log_;
  std::unique_ptr<Controller> controller_;
  Odometry odometry_;
  Manipulator manipulator_;
  std::vector<bool> subscribed_;         // by ranger
  std::vector<RangerReading> readings_;  // by ranger; empty where not subscribed
  RangerReading unread_;                 // what only the scan log wants
  std::vector<bool> reads_beams_;        // by gripper: the controller subscribed, or it closes by itself
  std::vector<std::vector<std::optional<ObjectId>>>
      beams_;  // by gripper and beam: what breaks it; empty where not read
  std::string failure_;
};

}  // namespace troupe
