#include "ros/messages/convert.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace troupe::ros {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::size_t kColumns = 6;  // of a covariance: x, y, z, and rotations about x, y, z
constexpr std::uint8_t kUltrasound = 0;
constexpr std::uint8_t kFloat32 = 7;  // of a PointField
constexpr std::uint32_t kBytesPerFloat = 4;

// Only x, y and the heading vary in the plane.
void SetDiagonal(double (&covariance)[36], double x, double y, double heading) {
  const double variances[kColumns] = {x, y, 0.0, 0.0, 0.0, heading};
  for (std::size_t i = 0; i < kColumns; ++i) covariance[i * kColumns + i] = std::max(variances[i], kLeastVariance);
}

void Copy(const std::vector<double>& values, float* out) {
  std::transform(values.begin(), values.end(), out, [](double value) { return static_cast<float>(value); });
}

}  // namespace

Time ToTime(Tick tick, std::int64_t interval_ns) {
  const std::int64_t ns = static_cast<std::int64_t>(tick) * interval_ns;
  return {static_cast<std::int32_t>(ns / kNanosecondsPerSecond),
          static_cast<std::uint32_t>(ns % kNanosecondsPerSecond)};
}

Pose OdomInMap(const LocalizationDescription& localization, const Pose& X_WR, const Pose& estimate) {
  if (localization.type == LocalizationType::kGps) return {};  // exactly, without rounding
  return X_WR * Inverse(estimate);
}

Header MakeHeader(const Time& stamp, const std::string& frame, dds::WireArena& arena) {
  return {stamp, arena.Copy(frame)};
}

PoseMessage ToMessage(const Pose& pose) {
  const SinCosResult half = SinCos(0.5 * pose.heading);
  PoseMessage message{};
  message.position = {pose.x, pose.y, pose.z};
  message.orientation = {0.0, 0.0, half.sin, half.cos};
  return message;
}

TwistMessage ToMessage(const Twist& twist) {
  TwistMessage message{};
  message.linear = {twist.vx, twist.vy, 0.0};
  message.angular = {0.0, 0.0, twist.wz};
  return message;
}

TransformStamped MakeTransform(const Time& stamp, const std::string& parent, const std::string& child, const Pose& pose,
                               dds::WireArena& arena) {
  const PoseMessage place = ToMessage(pose);
  TransformStamped transform{};
  transform.header = MakeHeader(stamp, parent, arena);
  transform.child_frame_id = arena.Copy(child);
  transform.transform.translation = {place.position.x, place.position.y, place.position.z};
  transform.transform.rotation = place.orientation;
  return transform;
}

TfMessage MakeTfMessage(const std::vector<TransformStamped>& transforms, dds::WireArena& arena) {
  TfMessage message{};
  std::copy(transforms.begin(), transforms.end(), arena.Fill(message.transforms, transforms.size()));
  return message;
}

OdometryMessage MakeOdometry(const Time& stamp, const std::string& frame, const std::string& child, const Pose& pose,
                             const Twist& twist, const Covariance& error, dds::WireArena& arena) {
  OdometryMessage odometry{};
  odometry.header = MakeHeader(stamp, frame, arena);
  odometry.child_frame_id = arena.Copy(child);
  odometry.pose.pose = ToMessage(pose);
  SetDiagonal(odometry.pose.covariance, error.x, error.y, error.heading);
  odometry.twist.twist = ToMessage(twist);
  SetDiagonal(odometry.twist.covariance, error.vx, error.vy, error.wz);
  return odometry;
}

LaserScan MakeLaserScan(const Time& stamp, const std::string& frame, const RangeScan& scan, double period_seconds,
                        bool infinite, dds::WireArena& arena) {
  LaserScan message{};
  message.header = MakeHeader(stamp, frame, arena);
  message.angle_min = static_cast<float>(scan.fan.angle_min());
  message.angle_max = static_cast<float>(scan.fan.angle_max());
  message.angle_increment = static_cast<float>(scan.fan.angle_increment());
  message.time_increment = 0.0F;  // all rays at once
  message.scan_time = static_cast<float>(period_seconds);
  message.range_min = static_cast<float>(scan.limits.min);
  message.range_max = static_cast<float>(scan.limits.max);
  float* const ranges = arena.Fill(message.ranges, scan.ranges.size());
  Copy(scan.ranges, ranges);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const bool is_hit = scan.ranges[i] < scan.limits.max;
    if (infinite && !is_hit) ranges[i] = std::numeric_limits<float>::infinity();
  }
  Copy(scan.intensities, arena.Fill(message.intensities, scan.intensities.size()));
  return message;
}

RangeMessage MakeRange(const Time& stamp, const std::string& frame, const RangeScan& scan, dds::WireArena& arena) {
  RangeMessage message{};
  message.header = MakeHeader(stamp, frame, arena);
  message.radiation_type = kUltrasound;
  message.field_of_view = static_cast<float>(scan.fan.fov);
  message.min_range = static_cast<float>(scan.limits.min);
  message.max_range = static_cast<float>(scan.limits.max);
  message.range = static_cast<float>(scan.ranges.front());
  message.variance = static_cast<float>(scan.variance);
  return message;
}

PointCloud2 MakePointCloud(const Time& stamp, const std::string& frame, const std::vector<Pose>& X_FS,
                           const std::vector<double>& ranges, const std::vector<double>& limits,
                           dds::WireArena& arena) {
  std::vector<float> coordinates;
  for (std::size_t i = 0; i < X_FS.size(); ++i) {
    if (ranges[i] >= limits[i]) continue;  // no hit
    const Pose point = X_FS[i] * Pose{ranges[i], 0.0, 0.0, 0.0};
    for (const double coordinate : {point.x, point.y, point.z}) coordinates.push_back(static_cast<float>(coordinate));
  }
  PointCloud2 cloud{};
  cloud.header = MakeHeader(stamp, frame, arena);
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(coordinates.size() / 3);
  auto* field = arena.Fill(cloud.fields, 3);
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const char* const names[] = {"x", "y", "z"};
    *field++ = {arena.Copy(names[axis]), axis * kBytesPerFloat, kFloat32, 1};
  }
  cloud.point_step = 3 * kBytesPerFloat;
  cloud.row_step = cloud.point_step * cloud.width;
  std::uint8_t* bytes = arena.Fill(cloud.data, cloud.row_step);
  if (!coordinates.empty()) std::memcpy(bytes, coordinates.data(), cloud.row_step);
  cloud.is_dense = true;
  return cloud;
}

BatteryState MakeBatteryState(const Time& stamp, const std::string& frame, const PowerDescription& power,
                              const StoreState& store, dds::WireArena& arena) {
  constexpr std::uint8_t kCharging = 1;
  constexpr std::uint8_t kDischarging = 2;
  constexpr std::uint8_t kFull = 4;
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  BatteryState message{};
  message.header = MakeHeader(stamp, frame, arena);
  for (float* const value : {&message.voltage, &message.temperature, &message.current, &message.charge,
                             &message.capacity, &message.design_capacity, &message.percentage}) {
    *value = kUnknown;
  }
  if (!power.endless && power.capacity > 0.0) message.percentage = static_cast<float>(store.joules / power.capacity);
  const bool full = power.endless || store.joules >= power.capacity;
  message.power_supply_status = full ? kFull : (store.charge_watts > 0.0 ? kCharging : kDischarging);
  message.present = true;
  message.location = arena.Copy("");
  message.serial_number = arena.Copy("");
  return message;
}

JointStateMessage MakeJointState(const Time& stamp, const std::vector<NamedJoint>& joints, dds::WireArena& arena) {
  JointStateMessage message{};
  message.header = MakeHeader(stamp, "", arena);
  char** name = arena.Fill(message.name, joints.size());
  double* position = arena.Fill(message.position, joints.size());
  double* velocity = arena.Fill(message.velocity, joints.size());
  for (const NamedJoint& joint : joints) {
    *name++ = arena.Copy(joint.name);
    *position++ = joint.state.position;
    *velocity++ = joint.state.velocity;
  }
  return message;
}

HumbleRangeMessage WithoutVariance(const RangeMessage& range) {
  return {range.header, range.radiation_type, range.field_of_view, range.min_range, range.max_range, range.range};
}

}  // namespace troupe::ros
