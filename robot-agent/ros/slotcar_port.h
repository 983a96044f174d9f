// SlotcarPort: the robots of one agent in one ROS domain as Open-RMF sees them: their states are on /robot_state, and
// those with the controller `slotcar` drive along the paths of /robot_path_requests. Requests are for the robot of that
// name in the world; the name of the fleet does not count.
// Open-RMF repeats requests until the state shows them, so each is idempotent: a task id that is known already is
// ignored, and the state names the last request of a mode. A path that begins elsewhere is an error that the state
// shows (adapter error); the robot stands until the next path.
//
// All functions are called by the agent's thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "robot-agent/agent/gateway.h"
#include "robot-agent/controller/path_follower.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/messages/rmf.h"
#include "troupe/controller.h"

namespace troupe {

class SlotcarPort {
 public:
  // REQUIRES: the scene outlives the port, or the next call of ChangeWorld.
  SlotcarPort(const ros::RosNode& node, const Scene& scene, const std::vector<RobotId>& robots);

  // The motion along the robot's path; nothing before its first path.
  std::optional<Command> CommandFor(RobotId robot, const WorldState& state);
  // Writes the states that are due; `all`: of any tick, for readers that have come in a pause.
  void Publish(std::span<const RobotView* const> robots, bool all);
  // Another world that has the same robots.
  void ChangeWorld(const Scene& scene) { scene_ = &scene; }
  // The robots start again: drops their paths, and the requests that came before.
  void Restart();
  // Lines about requests that were refused since the last call.
  std::vector<std::string> DrainReports();

 private:
  struct Member {
    RobotId id;
    ros::RmfRobot robot = {};                   // what does not follow from the state of the world
    std::optional<PathFollower> follower = {};  // of a slotcar
    SlotcarParameters parameters = {};          // of a slotcar
    std::vector<ros::RmfLocation> path = {};    // as it was requested
    bool has_task = false;
    bool has_failed = false;  // the newest path did not begin where the robot was
    bool is_paused = false;
    bool is_docking = false;
    std::uint64_t pause_request = 0;
    std::uint64_t mode_request = 0;
  };
  // Those up to Jazzy, or from Kilted on.
  struct OfJazzy {
    explicit OfJazzy(const ros::RosNode& node);
    ros::RosWriter<ros::RobotStateMessage> states;
    std::optional<ros::RosReader<ros::ModeRequest>> modes;
  };
  struct OfKilted {
    explicit OfKilted(const ros::RosNode& node);
    ros::RosWriter<ros::LaterRobotStateMessage> states;
    std::optional<ros::RosReader<ros::LaterModeRequest>> modes;
  };

  // Before its first request.
  Member MakeMember(RobotId robot) const;
  Member* Find(const char* name);
  void Receive(const WorldState& state);
  void ApplyPath(const ros::PathRequest& request, const WorldState& state);
  void ApplyPause(const ros::PauseRequest& request);
  void ApplyMode(const char* name, std::uint32_t mode, std::uint64_t request);
  // A robot or a person is where the robot must not drive.
  bool IsBlocked(const Member& member, const WorldState& state) const;
  ros::RobotMode ModeOf(const Member& member, const WorldState& state) const;
  ros::RmfRobot StateOf(Member& member, const WorldState& state) const;

  const Scene* scene_;
  std::vector<Member> members_;
  std::unique_ptr<OfJazzy> jazzy_;                             // null: by distribution
  std::unique_ptr<OfKilted> kilted_;                           // null: as above
  std::unique_ptr<ros::RosReader<ros::PathRequest>> paths_;    // null: there is no slotcar
  std::unique_ptr<ros::RosReader<ros::PauseRequest>> pauses_;  // as above
  std::vector<std::string> reports_;
};

}  // namespace troupe
