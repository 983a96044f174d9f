// StepAction: the action simulation_interfaces/SimulateSteps: so many ticks from a pause, and pause again, with
// feedback after each.
#pragma once

#include <memory>
#include <string>

#include "common/protocol/messages.h"
#include "common/ros_dds/ros_participant.h"

namespace troupe {

class SimulationContext;

class StepAction {
 public:
  // `name`: of the action.
  StepAction(const ros::RosNode& node, const std::string& name, std::shared_ptr<const SimulationContext> context);
  ~StepAction();  // nothing is answered any more when it returns

  // What the run has come to.
  void Publish(const FrameMessage& frame);

 private:
  class Server;
  std::shared_ptr<Server> server_;  // shared with requests that wait for their answer
};

}  // namespace troupe
