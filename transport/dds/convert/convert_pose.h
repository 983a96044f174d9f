// Pose between its value and idl/world.idl.
#pragma once

#include "idl/world.h"
#include "troupe/pose.h"

namespace troupe::dds {

inline troupe_wire_Pose PoseToWire(const Pose& pose) {
  return {pose.x, pose.y, pose.z, pose.heading};
}

inline Pose PoseFromWire(const troupe_wire_Pose& wire) {
  return {wire.x, wire.y, wire.z, wire.heading};
}

}  // namespace troupe::dds
