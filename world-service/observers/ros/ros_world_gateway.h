// The gateway of the world to ROS 2: clock, map, markers and events. docs/ros2.md lists the topics.
//
// It speaks for the world as a whole; each agent publishes its own robots' sensors and odometry. It reaches ROS through
// the program ros-participant of the host (ros/link), so this process has no second DDS participant, and a fault of a
// ROS peer ends that program and not the run.
#pragma once

#include <memory>
#include <string>

#include "common/base/paths.h"
#include "common/spatial/scene.h"
#include "ros/messages/ros_options.h"
#include "world-service/service/run_observer.h"
#include "worldfile/sites/site.h"

namespace troupe {

// The run at its start.
struct RunInRos {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Site> site = {};  // the building of the world named `site_world`; null: none
  std::string site_world = {};
  AllowedPaths files = {};    // that ROS may see, as the drawings of a building
  bool has_released = false;  // a service before has made ticks of the run
};

// Throws std::exception if it cannot.
std::unique_ptr<RunObserver> MakeRosWorldGateway(const ros::RosOptions& options, RunInRos run);

}  // namespace troupe
