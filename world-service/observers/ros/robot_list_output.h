// RobotListOutput: writes the list of the run's robots for the ros-service-bridge, in the partition of the run, at the
// start and after each edit that changes it.
#pragma once

#include <optional>

#include "common/dds/binding/data_writer.h"
#include "common/ros/messages.h"
#include "common/ros/robot_list.h"
#include "common/ros_dds/ros_participant.h"

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
