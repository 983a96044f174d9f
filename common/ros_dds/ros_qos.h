// The QoS of ROS topics: it matches the readers of ROS tools and keeps a slow reader from delaying a tick.
// docs/ros2.md has the table.
#pragma once

#include <cstdint>

#include "common/dds/binding/qos.h"

namespace troupe::ros {

// Reliable, because a reliable writer matches both kinds of readers; volatile. A slow reader receives the latest
// `depth` samples.
dds::Qos Stream(std::int32_t depth);
// Reliable and kept for late readers: maps, static transforms, descriptions.
dds::Qos Latched(std::int32_t depth = 1);
// The latest command. A reliable reader matches only reliable writers, whose samples arrive even if they are sent
// before the reader has discovered the writer; these can wait for its acknowledgment. A best-effort one matches every
// writer.
dds::Qos Commands(bool reliable);
// Of services and their clients. All clients of a service get all responses, those to others too. So with few samples
// a response that is lost on the way could not be sent again, and one that a client has not read yet would be replaced,
// as soon as others call.
dds::Qos Service(std::int32_t depth = 1000);
// Of /rosout: the lines of the last 10 s, for late readers, too.
dds::Qos LogLines();
// Of the announcement of nodes.
dds::Qos Discovery();

}  // namespace troupe::ros
