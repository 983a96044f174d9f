// RadioPort: the radios of one robot in ROS: "<radio>/send" takes messages, "<radio>/received" has those that arrive.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "robot-agent/agent/gateway.h"
#include "robot-agent/ros/refusals.h"
#include "ros/connection/ros_endpoints.h"

namespace troupe {

class RadioPort {
 public:
  // REQUIRES: the scene outlives the port, or the next call of ChangeWorld.
  RadioPort(const ros::RosNode& node, const Scene& scene, RobotId robot);

  // Appends the messages received from ROS since the last call to those that the robot is to send.
  void AddMessages(std::vector<RadioMessage>& messages);

  // The messages that arrive at this tick. Once for each tick.
  void Publish(const RobotView& robot);

  // Another world that has the same robot.
  void ChangeWorld(const Scene& scene) { world_ = &scene.world(); }
  // Drops the messages that came before.
  void Restart();

  // A line for each radio that refused messages since the last call.
  std::vector<std::string> DrainReports();

 private:
  struct Radio {
    std::size_t sensor;      // in RobotDescription::sensors
    std::string topic;       // of messages to be sent
    std::size_t most_bytes;  // of a message
    std::unique_ptr<ros::RosReader<ros::String>> input;
    std::unique_ptr<ros::RosWriter<ros::String>> output;
    Refusals refusals = {};
    std::string reason = {};  // of the newest refusal
  };

  const WorldDescription* world_;
  std::vector<Radio> radios_;
};

}  // namespace troupe
