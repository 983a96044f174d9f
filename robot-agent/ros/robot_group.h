// RobotGroup: the robots of an agent in one ROS domain: one connection, a node for each robot, and the transforms that
// they share. A robot in a domain of its own has a group of its own, with /clock and /map.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robot-agent/agent/gateway.h"
#include "robot-agent/ros/command_input.h"
#include "robot-agent/ros/manipulator_port.h"
#include "robot-agent/ros/radio_port.h"
#include "robot-agent/ros/robot_output.h"
#include "ros/connection/clock_output.h"
#include "ros/connection/map_output.h"
#include "ros/connection/parameter_services.h"
#include "ros/connection/ros_log.h"
#include "ros/connection/type_description_service.h"
#include "ros/link/host_connection.h"
#include "ros/messages/robot_in_ros.h"

namespace troupe {

struct RobotInGroup {
  RobotId id;
  ros::RobotInRos in_ros;
};

class RobotGroup {
 public:
  // REQUIRES: `robots` is not empty, all in one domain; the scene outlives the group.
  RobotGroup(const ros::RosOptions& options, const Scene& scene, const std::vector<RobotInGroup>& robots);
  ~RobotGroup();

  ExternalCommand CommandFor(RobotId id, Tick tick);
  // Once for each tick, before Show.
  void PublishActions(const RobotView& robot);
  // `robots`: of the process, in the order of their ids.
  void Show(Tick tick, std::span<const RobotView* const> robots);
  // The same for the topics whose readers have come since that time.
  void Repeat(Tick tick, std::span<const RobotView* const> robots, std::chrono::steady_clock::time_point since);
  void ChangeWorld(const Scene& scene);
  void Restart();
  // The messages for the log of the run; also writes them to /rosout.
  std::vector<std::string> DrainReports();

 private:
  class Transforms;
  struct Member;

  Member* Find(RobotId id);
  void ShowRobots(Tick tick, std::span<const RobotView* const> robots);
  // Those from the index `first` on, as lines of the robot's node.
  void Log(const Member& robot, const std::vector<std::string>& reports, std::size_t first);

  ros::HostConnection connection_;
  std::vector<std::unique_ptr<Member>> members_;
  std::vector<Member*> by_id_;  // null for all other robots of the world
  std::optional<ros::RosLog> log_;
  std::unique_ptr<Transforms> shared_transforms_;  // null where each robot has its own
  std::optional<ros::ClockOutput> clock_;          // these two in a domain of its own
  std::optional<ros::MapOutput> map_;
  std::int64_t interval_ns_ = 0;
  bool shown_ = false;  // Show was called
};

}  // namespace troupe
