#include "ros/messages/convert.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "ros/messages/names.h"

namespace troupe::ros {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::size_t kColumns = 6;  // of a covariance: x, y, z, and rotations about x, y, z
constexpr std::uint8_t kUltrasound = 0;
constexpr std::uint8_t kFloat32 = 7;  // of a PointField
constexpr std::uint32_t kBytesPerFloat = 4;

// Only x, y and the heading vary in the plane.
// Zeros would be taken for unknown, or make filters singular.
void SetDiagonal(double (&covariance)[36], double x, double y, double heading) {
  const double variances[kColumns] = {x, y, 0.0, 0.0, 0.0, heading};
  for (std::size_t i = 0; i < kColumns; ++i) covariance[i * kColumns + i] = std::max(variances[i], kMinVariance);
}

void Copy(const std::vector<double>& values, float* out) {
  std::transform(values.begin(), values.end(), out, [](double value) { return static_cast<float>(value); });
}

double Square(double value) {
  return value * value;
}

constexpr std::int32_t kTriangleList = 11;
constexpr std::int32_t kDeleteAll = 3;  // as a marker's action
constexpr std::int8_t kOccupied = 100;
constexpr std::int8_t kFree = 0;

using PointMessage = geometry_msgs_msg_dds__Point_;

// The corners of the triangles that bound a prism, counter-clockwise as seen from outside.
void AddPrism(const ConvexPiece& piece, std::vector<PointMessage>& points) {
  const std::vector<Vec2>& v = piece.vertices;
  const auto at = [&](std::size_t i, double z) { return PointMessage{v[i].x(), v[i].y(), z}; };
  const auto triangle = [&points](const PointMessage& a, const PointMessage& b, const PointMessage& c) {
    points.push_back(a);
    points.push_back(b);
    points.push_back(c);
  };
  const double low = piece.z.min;
  const double high = piece.z.max;
  for (std::size_t i = 1; i + 1 < v.size(); ++i) {
    triangle(at(0, high), at(i, high), at(i + 1, high));
    triangle(at(0, low), at(i + 1, low), at(i, low));
  }
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::size_t next = (i + 1) % v.size();
    triangle(at(i, low), at(next, low), at(next, high));
    triangle(at(i, low), at(next, high), at(i, high));
  }
}

// Markers of pieces, one for each model.
class Markers {
 public:
  Markers(const WorldDescription& world, const char* name_space) : world_(world), name_space_(name_space) {}

  // Call before Add: viewers apply markers in order.
  void DeleteOthers(dds::WireArena& arena) {
    Marker marker{};
    marker.header = MakeHeader({}, kMapFrame, arena);
    marker.ns = arena.Copy(name_space_);
    marker.action = kDeleteAll;
    markers_.push_back(marker);
  }

  // `pose`: of the pieces' own frame in `frame`. `follows`: the marker moves with the frame.
  void Add(const std::map<ModelId, std::vector<const ConvexPiece*>>& pieces_by_model, const std::string& frame,
           const Pose& pose, bool follows, dds::WireArena& arena) {
    for (const auto& [model, pieces] : pieces_by_model) {
      if (pieces.size() > kMaxMarkerPieces) continue;
      const Color& color = world_.model(model).color;
      Marker marker{};
      marker.header = MakeHeader({}, frame, arena);
      marker.ns = arena.Copy(name_space_);
      marker.id = static_cast<std::int32_t>(model.index());
      marker.type = kTriangleList;
      marker.pose = ToMessage(pose);
      marker.scale = {1.0, 1.0, 1.0};
      marker.color = {static_cast<float>(color.r), static_cast<float>(color.g), static_cast<float>(color.b),
                      static_cast<float>(color.a)};
      marker.frame_locked = follows;
      std::vector<PointMessage> points;
      for (const ConvexPiece* piece : pieces) AddPrism(*piece, points);
      std::copy(points.begin(), points.end(), arena.Fill(marker.points, points.size()));
      markers_.push_back(marker);
    }
  }

  MarkerArray Message(dds::WireArena& arena) const {
    MarkerArray message{};
    std::copy(markers_.begin(), markers_.end(), arena.Fill(message.markers, markers_.size()));
    return message;
  }

 private:
  const WorldDescription& world_;
  const char* name_space_;
  std::vector<Marker> markers_;
};

std::map<ModelId, std::vector<const ConvexPiece*>> ByModel(const std::vector<ConvexPiece>& pieces) {
  std::map<ModelId, std::vector<const ConvexPiece*>> by_model;
  for (const ConvexPiece& piece : pieces) by_model[piece.model].push_back(&piece);
  return by_model;
}

}  // namespace

// Stamps are simulated time, from 0 at tick 0.
Time ToTime(Tick tick, std::int64_t interval_ns) {
  const std::int64_t ns = static_cast<std::int64_t>(tick) * interval_ns;
  return {static_cast<std::int32_t>(ns / kNanosecondsPerSecond),
          static_cast<std::uint32_t>(ns % kNanosecondsPerSecond)};
}

// The transform that a localization would publish: map to odom.
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

TransformStamped MakeTransform(const Time& stamp, const FixedFrame& frame, dds::WireArena& arena) {
  TransformStamped transform = MakeTransform(stamp, frame.parent, frame.frame, frame.X_PF, arena);
  if (frame.roll == 0.0 && frame.pitch == 0.0) return transform;
  const SinCosResult r = SinCos(0.5 * frame.roll);
  const SinCosResult p = SinCos(0.5 * frame.pitch);
  const SinCosResult y = SinCos(0.5 * frame.X_PF.heading);
  // The product of the quaternions about z, y and x.
  transform.transform.rotation = {
      r.sin * p.cos * y.cos - r.cos * p.sin * y.sin, r.cos * p.sin * y.cos + r.sin * p.cos * y.sin,
      r.cos * p.cos * y.sin - r.sin * p.sin * y.cos, r.cos * p.cos * y.cos + r.sin * p.sin * y.sin};
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

// Rays without a hit read the maximum; REP 117 asks for infinity, and some tools for the maximum.
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

// A sonar: the single range of a cone.
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

// In the frame F of the sensors' poses, m.
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

// Only the share of the store has a meaning here: values that are not simulated are NaN, as the message asks.
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

// m or rad, and their rates; the effort is left empty, as no force is simulated.
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

// Sums of absolute motions: the error is proportional to the way, and its sign is not known to a filter.
void OdometryError::AddMotion(const Twist& twist, double seconds) {
  twist_ = twist;
  along_x_ += std::fabs(twist.vx) * seconds;
  along_y_ += std::fabs(twist.vy) * seconds;
  turned_ += std::fabs(twist.wz) * seconds;
}

Covariance OdometryError::covariance() const {
  if (localization_.type == LocalizationType::kGps) return {};
  // A wrong heading displaces the position, in both directions, by at most its error times the path length.
  const double displacement = localization_.error_heading * turned_ * (along_x_ + along_y_);
  return {.x = Square(localization_.error_x * along_x_) + Square(displacement),
          .y = Square(localization_.error_y * along_y_) + Square(displacement),
          .heading = Square(localization_.error_heading * turned_),
          .vx = Square(localization_.error_x * twist_.vx),
          .vy = Square(localization_.error_y * twist_.vy),
          .wz = Square(localization_.error_heading * twist_.wz)};
}

// Stamp 0 and latched: the map holds for the whole world.
OccupancyGridMessage MakeMap(const OccupancyGrid& grid, dds::WireArena& arena) {
  OccupancyGridMessage message{};
  message.header = MakeHeader({}, kMapFrame, arena);
  message.info.resolution = static_cast<float>(grid.resolution);
  message.info.width = grid.width;
  message.info.height = grid.height;
  message.info.origin = ToMessage(Pose{grid.origin_x, grid.origin_y, 0.0, 0.0});
  std::int8_t* cell = arena.Fill(message.data, grid.occupied.size());
  for (const bool occupied : grid.occupied) *cell++ = occupied ? kOccupied : kFree;
  return message;
}

// A static marker in the map's frame, and one for each link of a robot, which moves with its frame on tf.
MarkerArray MakeBlockMarkers(const Scene& scene, const std::vector<std::vector<std::string>>& robot_frames,
                             dds::WireArena& arena, bool replaces) {
  Markers markers(scene.world(), "blocks");
  if (replaces) markers.DeleteOthers(arena);
  markers.Add(ByModel(scene.static_index().kept_pieces()), kMapFrame, {}, false, arena);
  for (std::size_t i = 0; i < robot_frames.size(); ++i) {
    if (robot_frames[i].empty()) continue;
    const Body& body = scene.body(scene.body_of(RobotId(i)));
    std::vector<std::vector<ConvexPiece>> pieces(body.links.size());
    for (std::size_t k = 0; k < body.pieces.size(); ++k) pieces[body.piece_links[k]].push_back(body.pieces[k]);
    for (std::size_t k = 0; k < pieces.size(); ++k)
      markers.Add(ByModel(pieces[k]), robot_frames[i][k], {}, true, arena);
  }
  return markers.Message(arena);
}

MarkerArray MakeObjectMarkers(const Scene& scene, const WorldState& state, dds::WireArena& arena, bool replaces) {
  Markers markers(scene.world(), "objects");
  if (replaces) markers.DeleteOthers(arena);
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    markers.Add(ByModel(scene.body(scene.body_of(ObjectId(i))).pieces), kMapFrame, state.objects[i].X_WO, false, arena);
  }
  return markers.Message(arena);
}

PeopleMessage MakePeople(const WorldDescription& world, const WorldState& state, dds::WireArena& arena) {
  std::vector<std::size_t> present;
  for (std::size_t i = 0; i < state.people.size(); ++i) {
    if (!world.model(world.people[i].root).removed && !IsAway(state.people[i])) present.push_back(i);
  }
  PeopleMessage message{};
  message.header = MakeHeader(ToTime(state.tick, world.interval_ns), kMapFrame, arena);
  auto* person = arena.Fill(message.people, present.size());
  for (const std::size_t i : present) {
    const PersonState& from = state.people[i];
    person->name = arena.Copy(world.model(world.people[i].root).name);
    person->position = {from.X_WP.x, from.X_WP.y, from.X_WP.z};
    person->velocity = {from.vx, from.vy, 0.0};
    person->reliability = 1.0;
    ++person;
  }
  return message;
}

}  // namespace troupe::ros
