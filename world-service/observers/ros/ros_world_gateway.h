// The gateway of the world to ROS 2: clock, map, markers and events. docs/ros2.md lists the topics.
//
// It speaks for the world as a whole; each agent publishes its own robots' sensors and odometry. It reaches ROS through
// the program ros-participant of the host (ros/link), so this process has no second DDS participant, and a fault of a
// ROS peer ends that program and not the run.
#pragma once

#include <memory>
#include <string>

#include "common/spatial/scene.h"
#include "ros/messages/ros_options.h"
#include "world-service/service/run_observer.h"
#include "worldfile/sites/site.h"

namespace troupe {

// `site`: the building that the world named `site_world` was made from; null: none. Throws std::exception if it cannot.
std::unique_ptr<RunObserver> MakeRosWorldGateway(const ros::RosOptions& options, std::shared_ptr<const Scene> scene,
                                                 std::shared_ptr<const Site> site, const std::string& site_world);

}  // namespace troupe
