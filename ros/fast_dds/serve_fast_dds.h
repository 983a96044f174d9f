// The side of ros-participant that serves clients on Fast DDS: a process of its own, because a datagram of a stranger
// can end a process on Fast DDS 2.9 by one of its assertions.
// It has one thread, which reads the link and lets Fast DDS call listeners on its own threads. The other side starts it
// again after an end and repeats its services (FastDdsSide).
#pragma once

#include "common/base/wake_event.h"
#include "ros/messages/ros_options.h"

namespace troupe::ros {

// Serves the services that arrive over the connected socket, and passes their calls on over it, until the other side
// has gone or `stop` is signalled. Owns the descriptor. The name of the process in its warnings is `ros-participant`.
void ServeFastDds(const RosNetwork& network, int descriptor, const WakeEvent& stop);

}  // namespace troupe::ros
