// CyclonePrograms: finds out whether a ROS domain has programs on Cyclone DDS beside the participants of runs.
// Services are on Cyclone DDS only where a program could call them: each would be discovered twice by every tool. Once
// found, they stay: a program that has left may come back.
#pragma once

#include <functional>

#include "ros/connection/ros_participant.h"
#include "transport/dds/binding/entity.h"

namespace troupe::ros {

class CyclonePrograms {
 public:
  // `wake` is called on any thread when Found may have changed. The participant must outlive this. Throws
  // dds::Exception.
  CyclonePrograms(const RosParticipant& participant, std::function<void()> wake);
  ~CyclonePrograms() { participants_.close(); }
  CyclonePrograms(const CyclonePrograms&) = delete;
  CyclonePrograms& operator=(const CyclonePrograms&) = delete;

  // Whether there has been one.
  bool Found();

 private:
  bool found_ = false;
  dds::DataReaderListener listener_;
  dds::Entity participants_;  // a reader of discovered participants
};

}  // namespace troupe::ros
