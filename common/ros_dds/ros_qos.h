// The QoS of ROS topics: what the readers of ROS tools need to match, and what keeps a slow reader from slowing a tick.
// docs/ros2.md has the table.
#pragma once

#include <cstdint>

#include "common/dds/qos.h"

namespace troupe::ros {

// Reliable, volatile: a reliable writer serves both kinds of readers. Nothing but the latest `depth` samples is kept
// for a reader that is slow.
dds::Qos Stream(std::int32_t depth);
// Reliable, and kept for latecomers: maps, static transforms, descriptions.
dds::Qos Latched(std::int32_t depth = 1);
// The latest command. A best-effort reader takes commands of every writer; a reliable one those of reliable writers
// only, which then know that it has them.
dds::Qos Commands(bool reliable);
// Of services and their clients.
dds::Qos Service(std::int32_t depth = 10);
// Which nodes a participant has.
dds::Qos Discovery();

}  // namespace troupe::ros
