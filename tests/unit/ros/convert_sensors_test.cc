#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "ros/messages/convert.h"

namespace troupe::ros {
namespace {

// 3 x 2 pixels.
CameraReading SomeView() {
  CameraReading reading{.width = 3,
                        .height = 2,
                        .focal_length_x = 1.5,
                        .focal_length_y = 2.5,
                        .center_x = 1.25,
                        .center_y = -0.5,
                        .limits = {0.2, 8.0}};
  for (std::uint8_t i = 0; i < 18; ++i) reading.colors.push_back(i);
  reading.depths = {1.0F, 2.0F, std::numeric_limits<float>::infinity(), 4.0F, 5.0F, 6.0F};
  return reading;
}

TEST(ConvertSensors, AnImageHasTheBytesOfItsPixels) {
  dds::WireArena arena;
  const ImageMessage image = MakeColorImage({1, 2}, "eye_optical", SomeView(), arena);
  EXPECT_STREQ(image.header.frame_id, "eye_optical");
  EXPECT_STREQ(image.encoding, "rgb8");
  EXPECT_EQ(image.width, 3u);
  EXPECT_EQ(image.height, 2u);
  EXPECT_EQ(image.step, 9u);
  ASSERT_EQ(image.data._length, 18u);
  for (std::uint8_t i = 0; i < 18; ++i) EXPECT_EQ(image.data._buffer[i], i);
}

TEST(ConvertSensors, ADepthImageHasFloats) {
  dds::WireArena arena;
  const ImageMessage image = MakeDepthImage({1, 2}, "eye_optical", SomeView(), arena);
  EXPECT_STREQ(image.encoding, "32FC1");
  EXPECT_EQ(image.step, 12u);
  ASSERT_EQ(image.data._length, 24u);
  float depths[6];
  std::memcpy(depths, image.data._buffer, sizeof depths);
  EXPECT_EQ(std::vector<float>(depths, depths + 6), SomeView().depths);
}

TEST(ConvertSensors, AnImuHasTheVariancesOfItsNoise) {
  const ImuReading reading{.heading = kPi / 2,
                           .turn = 0.5,
                           .force_xy = {1.0, -2.0},
                           .force_z = 9.81,
                           .heading_noise = 0.1,
                           .turn_noise = 0.2,
                           .force_noise = 0.3};
  dds::WireArena arena;
  const ImuMessage message = MakeImuMessage({1, 2}, "imu", reading, arena);
  EXPECT_STREQ(message.header.frame_id, "imu");
  EXPECT_NEAR(message.orientation.z, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(message.orientation.w, std::sqrt(0.5), 1e-12);
  EXPECT_EQ(message.angular_velocity.z, 0.5);
  EXPECT_EQ(message.linear_acceleration.x, 1.0);
  EXPECT_EQ(message.linear_acceleration.y, -2.0);
  EXPECT_EQ(message.linear_acceleration.z, 9.81);
  EXPECT_NEAR(message.orientation_covariance[8], 0.01, 1e-12);
  EXPECT_GT(message.orientation_covariance[0], 0.0) << "0 everywhere would mean that it is not known";
  EXPECT_NEAR(message.angular_velocity_covariance[8], 0.04, 1e-12);
  for (const int axis : {0, 4, 8}) EXPECT_NEAR(message.linear_acceleration_covariance[axis], 0.09, 1e-12);
  EXPECT_EQ(message.linear_acceleration_covariance[1], 0.0);
}

TEST(ConvertSensors, TheOpticsProjectPointsOntoTheirPixels) {
  dds::WireArena arena;
  const CameraInfo info = MakeCameraInfo({1, 2}, "eye_optical", SomeView(), arena);
  EXPECT_EQ(info.width, 3u);
  EXPECT_STREQ(info.distortion_model, "plumb_bob");
  EXPECT_EQ(info.d._length, 5u);
  const double k[] = {1.5, 0.0, 1.25, 0.0, 2.5, -0.5, 0.0, 0.0, 1.0};
  const double p[] = {1.5, 0.0, 1.25, 0.0, 0.0, 2.5, -0.5, 0.0, 0.0, 0.0, 1.0, 0.0};
  for (int i = 0; i < 9; ++i) EXPECT_EQ(info.k[i], k[i]) << i;
  for (int i = 0; i < 9; ++i) EXPECT_EQ(info.r[i], i % 4 == 0 ? 1.0 : 0.0) << i;
  for (int i = 0; i < 12; ++i) EXPECT_EQ(info.p[i], p[i]) << i;
}

TEST(ConvertSensors, AnOpticalFrameLooksAlongZ) {
  dds::WireArena arena;
  const TransformStamped transform = MakeOpticalTransform({}, "eye", "eye_optical", arena);
  const auto& q = transform.transform.rotation;
  // The third column of the rotation: z of the optical frame in the camera's, which is x.
  EXPECT_DOUBLE_EQ(2.0 * (q.x * q.z + q.w * q.y), 1.0);
  EXPECT_DOUBLE_EQ(2.0 * (q.y * q.z - q.w * q.x), 0.0);
  EXPECT_DOUBLE_EQ(1.0 - 2.0 * (q.x * q.x + q.y * q.y), 0.0);
  // The first: x of the optical frame, which is to the right.
  EXPECT_DOUBLE_EQ(2.0 * (q.x * q.y + q.w * q.z), -1.0);
}

TEST(ConvertSensors, ACloudHasTheHitsOfAllPlanes) {
  RangeScan scan{.ranges = {1.0, 9.0, 9.0, 2.0},
                 .intensities = {0.5, 0.0, 0.0, 1.0},
                 .fan = {2.0, 2},
                 .elevations = {-0.5, 0.25},
                 .limits = {0.0, 9.0}};
  dds::WireArena arena;
  const PointCloud2 cloud = MakeScanCloud({1, 2}, "lidar", scan, arena);
  ASSERT_EQ(cloud.width, 2u);
  ASSERT_EQ(cloud.fields._length, 4u);
  EXPECT_STREQ(cloud.fields._buffer[3].name, "intensity");
  EXPECT_EQ(cloud.fields._buffer[3].offset, 12u);
  float values[8];
  ASSERT_EQ(cloud.data._length, sizeof values);
  std::memcpy(values, cloud.data._buffer, sizeof values);
  const double expected[] = {
      std::cos(0.5) * std::cos(1.0),        -std::cos(0.5) * std::sin(1.0),       -std::sin(0.5),       0.5,
      2.0 * std::cos(0.25) * std::cos(1.0), 2.0 * std::cos(0.25) * std::sin(1.0), 2.0 * std::sin(0.25), 1.0};
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(values[i], expected[i], 1e-6) << i;
}

TEST(ConvertSensors, FiducialsAreBoxesOfTheirModels) {
  WorldDescription world;
  world.models.resize(3);
  world.models[2].name = "crate";
  FiducialReading reading;
  reading.fiducials.push_back({.id = 7,
                               .model = ModelId(2),
                               .range = 2.0,
                               .bearing = 0.5,
                               .X_SF = {1.75, 1.0, -0.2, 0.5 * kPi},
                               .size_x = 0.4,
                               .size_y = 0.5,
                               .size_z = 0.6});
  reading.fiducials.push_back(reading.fiducials.front());
  reading.fiducials.back().id = 0;
  dds::WireArena arena;
  const Detection3dArray array = MakeFiducialDetections({1, 2}, "r/fiducial", world, reading, arena);
  EXPECT_STREQ(array.header.frame_id, "r/fiducial");
  ASSERT_EQ(array.detections._length, 2u);
  const auto& detection = array.detections._buffer[0];
  EXPECT_STREQ(detection.header.frame_id, "r/fiducial");
  EXPECT_EQ(detection.header.stamp.sec, 1);
  EXPECT_STREQ(detection.id, "crate");
  ASSERT_EQ(detection.results._length, 1u);
  const auto& result = detection.results._buffer[0];
  EXPECT_STREQ(result.hypothesis.class_id, "7");
  EXPECT_EQ(result.hypothesis.score, 1.0);
  EXPECT_EQ(result.pose.pose.position.x, 1.75);
  EXPECT_EQ(result.pose.pose.position.z, -0.2);
  EXPECT_NEAR(result.pose.pose.orientation.z, std::sqrt(0.5), 1e-12);
  EXPECT_EQ(result.pose.covariance[0], kLeastVariance);
  EXPECT_EQ(result.pose.covariance[1], 0.0);
  EXPECT_EQ(detection.bbox.center.position.x, 1.75);
  EXPECT_DOUBLE_EQ(detection.bbox.center.position.z, 0.1);
  EXPECT_EQ(detection.bbox.size.x, 0.4);
  EXPECT_EQ(detection.bbox.size.z, 0.6);
  EXPECT_STREQ(array.detections._buffer[1].results._buffer[0].hypothesis.class_id, "0");
  EXPECT_EQ(MakeFiducialDetections({}, "f", world, {}, arena).detections._length, 0u);
}

TEST(ConvertSensors, BlobsAreBoxesOfPixels) {
  BlobfinderReading reading{.width = 80, .height = 60, .fov = 1.0};
  reading.blobs.push_back({{1.0, 0.5, 0.0, 1.0}, 10, 20, 30, 50, 4.0});
  dds::WireArena arena;
  const Detection2dArray array = MakeBlobDetections({1, 2}, "r/blobfinder", reading, arena);
  ASSERT_EQ(array.detections._length, 1u);
  const auto& detection = array.detections._buffer[0];
  EXPECT_EQ(detection.bbox.center.position.x, 20.0);
  EXPECT_EQ(detection.bbox.center.position.y, 35.0);
  EXPECT_EQ(detection.bbox.center.theta, 0.0);
  EXPECT_EQ(detection.bbox.size_x, 20.0);
  EXPECT_EQ(detection.bbox.size_y, 30.0);
  const auto& result = detection.results._buffer[0];
  EXPECT_STREQ(result.hypothesis.class_id, "#ff8000");
  EXPECT_NEAR(result.pose.pose.position.x, 4.0 * std::cos(0.25), 1e-12);
  EXPECT_NEAR(result.pose.pose.position.y, 4.0 * std::sin(0.25), 1e-12);
}

}  // namespace
}  // namespace troupe::ros
