#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "ros/messages/convert.h"
#include "troupe/deterministic_math.h"

namespace troupe::ros {
namespace {

// Samples are copied as the bytes of messages that say little-endian.
static_assert(std::endian::native == std::endian::little);

constexpr std::uint8_t kFloatField = 7;  // of a PointField
constexpr std::uint32_t kFloatSize = 4;

ImageMessage MakeImage(const Time& stamp, const std::string& frame, const CameraReading& reading,
                       const std::string& encoding, std::uint32_t bytes_per_pixel, const void* data,
                       dds::WireArena& arena) {
  ImageMessage image{};
  image.header = MakeHeader(stamp, frame, arena);
  image.height = reading.height;
  image.width = reading.width;
  image.encoding = arena.Copy(encoding);
  image.is_bigendian = 0;
  image.step = bytes_per_pixel * reading.width;
  const std::size_t size = std::size_t{image.step} * reading.height;
  std::uint8_t* const bytes = arena.Fill(image.data, size);
  if (size > 0) std::memcpy(bytes, data, size);
  return image;
}

// One class, for certain, at an exact pose.
template <typename Detection>
void AddHypothesis(const std::string& class_id, const Pose& pose, Detection& detection, dds::WireArena& arena) {
  auto* const result = arena.Fill(detection.results, 1);
  result->hypothesis = {arena.Copy(class_id), 1.0};
  result->pose.pose = ToMessage(pose);
  for (std::size_t i = 0; i < 6; ++i) result->pose.covariance[7 * i] = kMinVariance;
}

std::string HexOf(const Color& color) {
  const auto byte = [](double share) { return std::lround(std::clamp(share, 0.0, 1.0) * 255.0); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(color.r), byte(color.g), byte(color.b));
}

}  // namespace

ImageMessage MakeColorImage(const Time& stamp, const std::string& frame, const CameraReading& reading,
                            dds::WireArena& arena) {
  return MakeImage(stamp, frame, reading, "rgb8", 3, reading.colors.data(), arena);
}

ImageMessage MakeDepthImage(const Time& stamp, const std::string& frame, const CameraReading& reading,
                            dds::WireArena& arena) {
  return MakeImage(stamp, frame, reading, "32FC1", kFloatSize, reading.depths.data(), arena);
}

// A pinhole camera without distortion: K and P have the same numbers, R is the identity.
CameraInfo MakeCameraInfo(const Time& stamp, const std::string& frame, const CameraReading& reading,
                          dds::WireArena& arena) {
  CameraInfo info{};
  info.header = MakeHeader(stamp, frame, arena);
  info.height = reading.height;
  info.width = reading.width;
  info.distortion_model = arena.Copy("plumb_bob");
  std::fill_n(arena.Fill(info.d, 5), 5, 0.0);
  const double k[9] = {
      reading.focal_length_x, 0.0, reading.center_x, 0.0, reading.focal_length_y, reading.center_y, 0.0, 0.0, 1.0};
  std::copy(std::begin(k), std::end(k), info.k);
  for (std::size_t i = 0; i < 3; ++i) {
    info.r[4 * i] = 1.0;
    std::copy_n(k + 3 * i, 3, info.p + 4 * i);
  }
  return info;
}

// REP 103: an optical frame has z ahead, x to the right, y down.
TransformStamped MakeOpticalTransform(const Time& stamp, const std::string& camera, const std::string& optical,
                                      dds::WireArena& arena) {
  TransformStamped transform = MakeTransform(stamp, camera, optical, {}, arena);
  transform.transform.rotation = {-0.5, 0.5, -0.5, 0.5};
  return transform;
}

// In the frame of the sensor; rays without a hit are left out.
PointCloud2 MakeScanCloud(const Time& stamp, const std::string& frame, const RangeScan& scan, dds::WireArena& arena) {
  std::vector<float> values;
  values.reserve(4 * scan.ranges.size());
  for (std::size_t plane = 0; plane < scan.planes(); ++plane) {
    const SinCosResult climb = SinCos(scan.elevation(plane));
    for (std::size_t i = 0; i < scan.fan.count; ++i) {
      const std::size_t place = plane * scan.fan.count + i;
      const double range = scan.ranges[place];
      if (range >= scan.limits.max) continue;  // no hit
      const SinCosResult turn = SinCos(scan.fan.Bearing(i));
      const double ahead = range * climb.cos;
      for (const double value : {ahead * turn.cos, ahead * turn.sin, range * climb.sin, scan.intensities[place]}) {
        values.push_back(static_cast<float>(value));
      }
    }
  }
  PointCloud2 cloud{};
  cloud.header = MakeHeader(stamp, frame, arena);
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(values.size() / 4);
  auto* field = arena.Fill(cloud.fields, 4);
  const char* const names[] = {"x", "y", "z", "intensity"};
  for (std::uint32_t i = 0; i < 4; ++i) *field++ = {arena.Copy(names[i]), i * kFloatSize, kFloatField, 1};
  cloud.point_step = 4 * kFloatSize;
  cloud.row_step = cloud.point_step * cloud.width;
  std::uint8_t* const bytes = arena.Fill(cloud.data, cloud.row_step);
  if (!values.empty()) std::memcpy(bytes, values.data(), cloud.row_step);
  cloud.is_dense = true;
  return cloud;
}

// The hypothesis is the fiducial's id, the detection's id the name of the model.
Detection3dArray MakeFiducialDetections(const Time& stamp, const std::string& frame, const WorldDescription& world,
                                        const FiducialReading& reading, dds::WireArena& arena) {
  Detection3dArray array{};
  array.header = MakeHeader(stamp, frame, arena);
  auto* detection = arena.Fill(array.detections, reading.fiducials.size());
  for (const Fiducial& fiducial : reading.fiducials) {
    *detection = {};
    detection->header = MakeHeader(stamp, frame, arena);
    AddHypothesis(std::to_string(fiducial.id), fiducial.X_SF, *detection, arena);
    Pose middle = fiducial.X_SF;
    middle.z += 0.5 * fiducial.size_z;  // a model stands on its origin
    detection->bbox.center = ToMessage(middle);
    detection->bbox.size = {fiducial.size_x, fiducial.size_y, fiducial.size_z};
    detection->id = arena.Copy(world.model(fiducial.model).name);
    ++detection;
  }
  return array;
}

// Roll and pitch are 0 in two and a half dimensions; their variances are the smallest that filters accept.
ImuMessage MakeImuMessage(const Time& stamp, const std::string& frame, const ImuReading& reading,
                          dds::WireArena& arena) {
  ImuMessage message{};
  message.header = MakeHeader(stamp, frame, arena);
  message.orientation = ToMessage(Pose{0.0, 0.0, 0.0, reading.heading}).orientation;
  message.angular_velocity.z = reading.turn;
  message.linear_acceleration = {reading.force_xy.x(), reading.force_xy.y(), reading.force_z};
  const auto variance = [](double deviation) { return std::max(deviation * deviation, kMinVariance); };
  for (const std::size_t axis : {0, 4, 8}) {  // of a 3 x 3 matrix
    const bool is_z = axis == 8;
    message.orientation_covariance[axis] = variance(is_z ? reading.heading_noise : 0.0);
    message.angular_velocity_covariance[axis] = variance(is_z ? reading.turn_noise : 0.0);
    message.linear_acceleration_covariance[axis] = variance(reading.force_noise);
  }
  return message;
}

// Pixels for the box; the hypothesis has the place in the plane, from the column and the range.
Detection2dArray MakeBlobDetections(const Time& stamp, const std::string& frame, const BlobfinderReading& reading,
                                    dds::WireArena& arena) {
  Detection2dArray array{};
  array.header = MakeHeader(stamp, frame, arena);
  auto* detection = arena.Fill(array.detections, reading.blobs.size());
  for (const Blob& blob : reading.blobs) {
    *detection = {};
    detection->header = MakeHeader(stamp, frame, arena);
    const double x = 0.5 * (double{1} * blob.left + blob.right);
    const double y = 0.5 * (double{1} * blob.top + blob.bottom);
    const SinCosResult direction = SinCos(reading.fov * (0.5 - x / reading.width));
    AddHypothesis(HexOf(blob.color), {blob.range * direction.cos, blob.range * direction.sin, 0.0, 0.0}, *detection,
                  arena);
    detection->bbox.center = {{x, y}, 0.0};
    detection->bbox.size_x = blob.right - blob.left;
    detection->bbox.size_y = blob.bottom - blob.top;
    detection->id = arena.Copy("");
    ++detection;
  }
  return array;
}

}  // namespace troupe::ros
