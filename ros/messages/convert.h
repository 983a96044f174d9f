// Pure functions from values of the simulation to ROS messages. The strings and sequences of a message live in the
// arena. A heading becomes a rotation about z.
#pragma once

#include <string>
#include <vector>

#include "ros/messages/messages.h"
#include "ros/messages/odometry_error.h"
#include "transport/dds/binding/wire.h"
#include "troupe/pose.h"
#include "troupe/sensor.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe::ros {

// Simulated time: tick * interval.
Time ToTime(Tick tick, std::int64_t interval_ns);

// X_WO of a robot's odometry frame O, from the robot's pose and its own estimate X_OR at the start of odometry.
Pose OdomInMap(const LocalizationDescription& localization, const Pose& X_WR, const Pose& estimate);

Header MakeHeader(const Time& stamp, const std::string& frame, dds::WireArena& arena);
PoseMessage ToMessage(const Pose& pose);
TwistMessage ToMessage(const Twist& twist);
TransformStamped MakeTransform(const Time& stamp, const std::string& parent, const std::string& child, const Pose& pose,
                               dds::WireArena& arena);
TfMessage MakeTfMessage(const std::vector<TransformStamped>& transforms, dds::WireArena& arena);

// `pose` is of `child` in `frame`; `twist` in `child`. No variance is below kLeastVariance, which also is that of the
// components out of the plane: filters reject a variance of zero.
inline constexpr double kLeastVariance = 1e-6;  // m^2, rad^2, and of velocities: 1 mm, 1 mrad
OdometryMessage MakeOdometry(const Time& stamp, const std::string& frame, const std::string& child, const Pose& pose,
                             const Twist& twist, const Covariance& error, dds::WireArena& arena);

// One scan of one ray sensor, in the sensor's frame. A ray without a hit has the range +Inf (REP 117) or, unless
// `infinite`, range_max. `period_seconds`: from one scan to the next.
LaserScan MakeLaserScan(const Time& stamp, const std::string& frame, const RangeScan& scan, double period_seconds,
                        bool infinite, dds::WireArena& arena);

// The first ray of a scan. REQUIRES: it has one.
RangeMessage MakeRange(const Time& stamp, const std::string& frame, const RangeScan& scan, dds::WireArena& arena);
HumbleRangeMessage WithoutVariance(const RangeMessage& range);

// The hits of sensors with one ray each, as points in the frame F of `frame`. By sensor: `X_FS`, its pose; `ranges`, m;
// `limits`, its range_max in m. A sensor without a hit adds no point.
PointCloud2 MakePointCloud(const Time& stamp, const std::string& frame, const std::vector<Pose>& X_FS,
                           const std::vector<double>& ranges, const std::vector<double>& limits, dds::WireArena& arena);

// A joint of a robot with its name in ROS.
struct NamedJoint {
  std::string name;
  JointState state;
};
// The store of energy that feeds a robot's drive. Voltages, currents and charges are not known; nor is the percentage
// of an endless store.
BatteryState MakeBatteryState(const Time& stamp, const std::string& frame, const PowerDescription& power,
                              const StoreState& store, dds::WireArena& arena);

JointStateMessage MakeJointState(const Time& stamp, const std::vector<NamedJoint>& joints, dds::WireArena& arena);

}  // namespace troupe::ros
