// The gateway of the world to ROS 2: clock, map, markers and events. docs/ros2.md lists the topics.
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
