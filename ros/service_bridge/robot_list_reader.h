// RobotListReader: reads the list of the robots of the run, which its world service writes.
#pragma once

#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <optional>

#include "ros/messages/robot_list.h"
#include "ros/messages/ros_options.h"
#include "ros/service_bridge/inbox.h"
#include "ros/service_bridge/service_link.h"

namespace troupe::ros {

class RobotListReader final : private eprosima::fastdds::dds::DataReaderListener {
 public:
  // `run`: in the domain of the run. It and the inbox must outlive this. Throws std::runtime_error if the reader cannot
  // be made.
  RobotListReader(const LinkPort& run, Distribution distribution, Inbox& inbox);
  ~RobotListReader() override;
  RobotListReader(const RobotListReader&) = delete;
  RobotListReader& operator=(const RobotListReader&) = delete;

  // The newest list that has come since the last call. It notifies the part of the inbox.
  std::optional<RobotList> Take();
  Inbox::PartId part() const { return part_; }

 private:
  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override;

  const LinkPort run_;
  Inbox& inbox_;
  const Inbox::PartId part_;
  eprosima::fastdds::dds::Topic* topic_ = nullptr;
  eprosima::fastdds::dds::DataReader* reader_ = nullptr;
};

}  // namespace troupe::ros
