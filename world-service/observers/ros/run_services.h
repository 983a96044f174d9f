// StepAction: the action simulation_interfaces/SimulateSteps. A goal steps a paused run by a number of ticks and pauses
// it again, with feedback after each tick.
//
// At most one goal is open: a second one would wait for the first without saying so, and is rejected. Cancelling pauses
// the run at the next tick; the result says how many steps were made. A goal of a service that has died is reported as
// aborted, although its steps go on: the new service does not know the goal.
#pragma once

#include <memory>
#include <string>

#include "ros/connection/ros_connection.h"
#include "transport/protocol/messages.h"

namespace troupe {

class SimulationContext;

class StepAction {
 public:
  // `name`: of the action.
  StepAction(const ros::RosNode& node, const std::string& name, std::shared_ptr<SimulationContext> context);
  ~StepAction();  // no answer is sent after it returns

  // Counts a committed tick, and sends feedback.
  void Publish(const FrameMessage& frame);

 private:
  class Server;
  std::shared_ptr<Server> server_;  // shared with requests that wait for their answer
};

}  // namespace troupe
