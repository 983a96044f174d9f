// RobotListOutput: writes the list of the run's robots for the ros-service-bridge, in the partition of the run, at the
// start and after each edit that changes it.
#pragma once

#include <optional>

#include "ros/connection/ros_participant.h"
#include "ros/messages/messages.h"
#include "ros/messages/robot_list.h"
#include "transport/dds/binding/data_writer.h"

namespace troupe {

class RobotListOutput {
 public:
  // REQUIRES: UsesBridge(options).
  RobotListOutput(ros::RosParticipant& participant, const ros::RosOptions& options);

  void ChangeWorld(const WorldDescription& world);

 private:
  const ros::RosOptions options_;
  ros::RosParticipant& participant_;
  dds::Topic<ros::String> topic_;
  dds::DataWriter<ros::String> writer_;
  std::optional<ros::RobotList> written_;
};

}  // namespace troupe
