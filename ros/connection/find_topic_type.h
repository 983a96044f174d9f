// The types of topics by their names.
#pragma once

#include <dds/dds.h>

#include <string>

#include "ros/messages/ros_options.h"

namespace troupe::ros {

// A type of topic_types.h or simulation_types.h by its name on DDS ("nav_msgs::msg::dds_::Odometry_"), in the layout of
// the distribution; null: there is none.
const dds_topic_descriptor_t* FindTopicType(const std::string& name, Distribution distribution);

}  // namespace troupe::ros
