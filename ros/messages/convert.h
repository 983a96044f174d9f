// Pure functions from values of the simulation to ROS messages. The strings and sequences of a message live in the
// arena. A heading becomes a rotation about z.
// Units are SI in both worlds, and frames are those of REP 103 (x forward, y left, z up) and REP 105 (map, odom,
// base_link), so that no number is scaled or turned: only put at its place.
#pragma once

#include <string>
#include <vector>

#include "common/spatial/occupancy_grid.h"
#include "ros/messages/messages.h"
#include "ros/messages/robot_frames.h"
#include "transport/dds/binding/wire.h"
#include "troupe/pose.h"
#include "troupe/sensor.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe::ros {

// Variances of x, y (m^2) and heading (rad^2) of a pose, and of vx, vy (m^2/s^2) and wz (rad^2/s^2).
struct Covariance {
  double x = 0.0;
  double y = 0.0;
  double heading = 0.0;
  double vx = 0.0;
  double vy = 0.0;
  double wz = 0.0;
};

// OdometryError: the uncertainty of a robot's odometry, from the relative errors of its description.
class OdometryError {
 public:
  explicit OdometryError(const LocalizationDescription& localization) : localization_(localization) {}

  // Adds the motion of one tick. Errors are relative to motion, so they grow with the path length.
  void AddMotion(const Twist& twist, double seconds);

  // The squares of the largest possible errors; zeros for gps, which is exact.
  Covariance covariance() const;

 private:
  LocalizationDescription localization_;
  Twist twist_;
  // Path length along each component, forward and back alike: m, m, rad.
  double along_x_ = 0.0;
  double along_y_ = 0.0;
  double turned_ = 0.0;
};

// Simulated time: tick * interval.
Time ToTime(Tick tick, std::int64_t interval_ns);

// X_WO of a robot's odometry frame O, from the robot's pose and its own estimate X_OR at the start of odometry.
Pose OdomInMap(const LocalizationDescription& localization, const Pose& X_WR, const Pose& estimate);

Header MakeHeader(const Time& stamp, const std::string& frame, dds::WireArena& arena);
PoseMessage ToMessage(const Pose& pose);
TwistMessage ToMessage(const Twist& twist);
TransformStamped MakeTransform(const Time& stamp, const std::string& parent, const std::string& child, const Pose& pose,
                               dds::WireArena& arena);
TransformStamped MakeTransform(const Time& stamp, const FixedFrame& frame, dds::WireArena& arena);
TfMessage MakeTfMessage(const std::vector<TransformStamped>& transforms, dds::WireArena& arena);

// `pose` is of `child` in `frame`; `twist` in `child`. No variance is below kMinVariance, which also is that of the
// components out of the plane: filters reject a variance of zero.
inline constexpr double kMinVariance = 1e-6;  // m^2, rad^2, and of velocities: 1 mm, 1 mrad
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

// Pure functions from a world to ROS messages: its map, and markers of its blocks.

OccupancyGridMessage MakeMap(const OccupancyGrid& grid, dds::WireArena& arena);

// The static bodies in frame map, and the robots in their own frames. `robot_frames`: by robot, then by link of its
// body (RobotFrames::links); empty: no robots, or not this one. A model of more than kMaxMarkerPieces pieces is left
// out: it is a bitmap, and the map shows it. `replaces`: viewers first delete all markers of this namespace, because
// the world was replaced.
inline constexpr std::size_t kMaxMarkerPieces = 5000;
MarkerArray MakeBlockMarkers(const Scene& scene, const std::vector<std::vector<std::string>>& robot_frames,
                             dds::WireArena& arena, bool replaces = false);

// The movable objects, at their poses in `state`.
MarkerArray MakeObjectMarkers(const Scene& scene, const WorldState& state, dds::WireArena& arena,
                              bool replaces = false);

// The people at their places, with their velocities: exact, so the reliability is 1.
PeopleMessage MakePeople(const WorldDescription& world, const WorldState& state, dds::WireArena& arena);

// Pure functions from the readings of cameras, finders and scanners with several planes to ROS messages.

// Red, green and blue of each pixel, encoding "rgb8".
ImageMessage MakeColorImage(const Time& stamp, const std::string& frame, const CameraReading& reading,
                            dds::WireArena& arena);

// Depths in metres, encoding "32FC1": -Inf below the camera's range, +Inf beyond it (REP 117, REP 118).
ImageMessage MakeDepthImage(const Time& stamp, const std::string& frame, const CameraReading& reading,
                            dds::WireArena& arena);

// The camera's optics, without distortion.
CameraInfo MakeCameraInfo(const Time& stamp, const std::string& frame, const CameraReading& reading,
                          dds::WireArena& arena);

// From a camera's frame, which looks along x, to that of its images: z ahead, x to the right (REP 103).
TransformStamped MakeOpticalTransform(const Time& stamp, const std::string& camera, const std::string& optical,
                                      dds::WireArena& arena);

// The hits of a scan in its own frame, with their intensities: fields x, y, z and intensity.
PointCloud2 MakeScanCloud(const Time& stamp, const std::string& frame, const RangeScan& scan, dds::WireArena& arena);

// The fiducials in the finder's frame: of each a box of its model's size, its id as the class, and the name of the
// model as the id for tracking.
Detection3dArray MakeFiducialDetections(const Time& stamp, const std::string& frame, const WorldDescription& world,
                                        const FiducialReading& reading, dds::WireArena& arena);

// The IMU's measurement in its own frame; its heading is in the world. Roll and pitch, and their rates, are 0 exactly.
ImuMessage MakeImuMessage(const Time& stamp, const std::string& frame, const ImuReading& reading,
                          dds::WireArena& arena);

// The blobs in pixels: of each its colour as the class, "#rrggbb", and the place at its range in the direction of its
// middle as the pose, in the blobfinder's frame.
Detection2dArray MakeBlobDetections(const Time& stamp, const std::string& frame, const BlobfinderReading& reading,
                                    dds::WireArena& arena);

}  // namespace troupe::ros
