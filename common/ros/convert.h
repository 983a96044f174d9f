// Converters from the simulation to ROS messages: pure functions. Strings and sequences of what they return live in the
// arena. Poses are flat: a heading becomes a turn around z.
#pragma once

#include <string>
#include <vector>

#include "common/dds/wire.h"
#include "common/geometry/pose.h"
#include "common/model/world_description.h"
#include "common/model/world_state.h"
#include "common/ros/messages.h"
#include "common/ros/odometry_error.h"

namespace troupe::ros {

// Of simulated time: tick * interval.
Time ToTime(Tick tick, std::int64_t interval_ns);

// Where a robot's odometry frame is in the map, from where the robot is and believes to be when odometry starts.
Pose OdomInMap(const LocalizationDescription& localization, const Pose& X_WR, const Pose& estimate);

Header MakeHeader(const Time& stamp, const std::string& frame, dds::WireArena& arena);
PoseMessage ToMessage(const Pose& pose);
TwistMessage ToMessage(const Twist& twist);
TransformStamped MakeTransform(const Time& stamp, const std::string& parent, const std::string& child, const Pose& pose,
                               dds::WireArena& arena);
TfMessage MakeTfMessage(const std::vector<TransformStamped>& transforms, dds::WireArena& arena);

// `pose` is of `child` in `frame`; `twist` in `child`.
OdometryMessage MakeOdometry(const Time& stamp, const std::string& frame, const std::string& child, const Pose& pose,
                             const Twist& twist, const Covariance& error, dds::WireArena& arena);

// One scan of one sensor; `ranges` and `intensities` from RangeScan. A ray that met nothing has the range range_max.
LaserScan MakeLaserScan(const Time& stamp, const std::string& frame, const RangerDescription& ranger,
                        const RaySensorDescription& sensor, double interval_seconds, const std::vector<double>& ranges,
                        const std::vector<double>& intensities, dds::WireArena& arena);

RangeMessage MakeRange(const Time& stamp, const std::string& frame, const RaySensorDescription& sensor, double range,
                       dds::WireArena& arena);
HumbleRangeMessage WithoutVariance(const RangeMessage& range);

// A point for each sensor of one ray that met something, where it met it, in the frame of `X_FS`: the poses of the
// sensors. `ranges` and `limits` (range_max) likewise by sensor.
PointCloud2 MakePointCloud(const Time& stamp, const std::string& frame, const std::vector<Pose>& X_FS,
                           const std::vector<double>& ranges, const std::vector<double>& limits, dds::WireArena& arena);

// `joints`: the robot's, with their names in ROS.
struct NamedJoint {
  std::string name;
  JointState state;
};
JointStateMessage MakeJointState(const Time& stamp, const std::vector<NamedJoint>& joints, dds::WireArena& arena);

}  // namespace troupe::ros
