// RmfFleets: /fleet_states, as the adapter of a fleet of slotcars has them: for each fleet the newest states of its
// robots, which it collects from /robot_state. It reads these only while /fleet_states has a reader.
//
// The agents publish /robot_state, each for its own robots; none of them knows the others. The world's gateway is the
// one place that sees all, so it does what the fleet adapter of rmf_simulation does. It measures nothing: a robot whose
// agent is lost keeps its last state.
//
// RmfTopics calls it, in turns of the run.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "ros/connection/ros_connection.h"
#include "ros/messages/rmf.h"

namespace troupe {

class RmfFleets {
 public:
  explicit RmfFleets(const ros::RosNode& node);
  ~RmfFleets();
  RmfFleets(const RmfFleets&) = delete;
  RmfFleets& operator=(const RmfFleets&) = delete;

  void ChangeWorld(const WorldDescription& world);
  // Reads the states of robots, and writes the states of all fleets if they are due.
  void OnTick(bool is_due);

  // The topics in the layout of one distribution.
  class Topics;

 private:
  const std::unique_ptr<Topics> topics_;
  std::map<std::string, std::string> fleets_;    // by robot
  std::map<std::string, ros::RmfRobot> robots_;  // by name: the newest states
};

}  // namespace troupe
