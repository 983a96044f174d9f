#include "ros/messages/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "ros/messages/robot_frames.h"
#include "tests/support/small_world.h"

namespace troupe::ros {
namespace {

using testing::Each;
using testing::ElementsAre;

TEST(ToTime, IsExactAfterAnyNumberOfTicks) {
  EXPECT_EQ(ToTime(0, 100'000'000).sec, 0);
  const Time time = ToTime(1'000'003, 100'000'000);
  EXPECT_EQ(time.sec, 100'000);
  EXPECT_EQ(time.nanosec, 300'000'000u);
  EXPECT_EQ(ToTime(3, 999'999'999).sec, 2);
  EXPECT_EQ(ToTime(3, 999'999'999).nanosec, 999'999'997u);
}

TEST(ToMessage, ConvertsAHeadingToARotationAboutZ) {
  const PoseMessage pose = ToMessage(Pose{1.0, 2.0, 3.0, kPi / 2});
  EXPECT_EQ(pose.position.x, 1.0);
  EXPECT_EQ(pose.position.y, 2.0);
  EXPECT_EQ(pose.position.z, 3.0);
  EXPECT_EQ(pose.orientation.x, 0.0);
  EXPECT_EQ(pose.orientation.y, 0.0);
  EXPECT_NEAR(pose.orientation.z, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(pose.orientation.w, std::sqrt(0.5), 1e-15);
}

TEST(MakeOdometry, ContainsPoseTwistAndCovariances) {
  dds::WireArena arena;
  const Covariance error{.x = 0.1, .y = 0.2, .heading = 0.3, .vx = 0.4, .vy = 0.5, .wz = 0.6};
  const OdometryMessage odometry =
      MakeOdometry({7, 5}, "r/odom", "r/base_link", {1, 2, 0, 0}, {0.5, 0.25, -1.0}, error, arena);
  EXPECT_EQ(odometry.header.stamp.sec, 7);
  EXPECT_EQ(odometry.header.stamp.nanosec, 5u);
  EXPECT_STREQ(odometry.header.frame_id, "r/odom");
  EXPECT_STREQ(odometry.child_frame_id, "r/base_link");
  EXPECT_EQ(odometry.pose.pose.position.y, 2.0);
  EXPECT_EQ(odometry.twist.twist.linear.x, 0.5);
  EXPECT_EQ(odometry.twist.twist.linear.y, 0.25);
  EXPECT_EQ(odometry.twist.twist.angular.z, -1.0);
  EXPECT_EQ(odometry.pose.covariance[0], 0.1);
  EXPECT_EQ(odometry.pose.covariance[7], 0.2);
  EXPECT_EQ(odometry.pose.covariance[35], 0.3);
  EXPECT_EQ(odometry.twist.covariance[0], 0.4);
  EXPECT_EQ(odometry.twist.covariance[7], 0.5);
  EXPECT_EQ(odometry.twist.covariance[35], 0.6);
  for (const std::size_t z_roll_pitch : {14, 21, 28}) EXPECT_EQ(odometry.pose.covariance[z_roll_pitch], kMinVariance);
  EXPECT_EQ(odometry.pose.covariance[1], 0.0);
}

TEST(MakeLaserScan, HasTheAnglesOfTheFan) {
  const RangeScan measured{{.fan = {3.0, 4}, .limits = {0.25, 8.0}}, {1, 2, 3, 8}, {1, 1, 0.5, 0}};
  dds::WireArena arena;
  const LaserScan scan = MakeLaserScan({}, "r/scan", measured, 3 * 0.1, false, arena);
  EXPECT_EQ(scan.angle_min, -1.5F);
  EXPECT_EQ(scan.angle_max, 1.5F);
  EXPECT_EQ(scan.angle_increment, 1.0F);
  EXPECT_FLOAT_EQ(scan.scan_time, 0.3F);
  EXPECT_EQ(scan.range_min, 0.25F);
  EXPECT_EQ(scan.range_max, 8.0F);
  EXPECT_THAT(dds::Elements(scan.ranges), ElementsAre(1.0F, 2.0F, 3.0F, 8.0F));
  EXPECT_THAT(dds::Elements(scan.intensities), ElementsAre(1.0F, 1.0F, 0.5F, 0.0F));
  const LaserScan infinite = MakeLaserScan({}, "r/scan", measured, 3 * 0.1, true, arena);
  EXPECT_THAT(dds::Elements(infinite.ranges), ElementsAre(1.0F, 2.0F, 3.0F, std::numeric_limits<float>::infinity()));
  EXPECT_EQ(infinite.range_max, 8.0F);
}

TEST(MakeRange, HasNoVarianceInHumble) {
  const RangeScan scan{{.fan = {0.25, 1}, .limits = {0.0, 4.0}, .variance = 0.5}, {1.5}, {1.0}};
  dds::WireArena arena;
  const RangeMessage range = MakeRange({1, 2}, "r/sonar_0", scan, arena);
  EXPECT_EQ(range.range, 1.5F);
  EXPECT_EQ(range.max_range, 4.0F);
  EXPECT_EQ(range.field_of_view, 0.25F);
  EXPECT_EQ(range.variance, 0.5F);
  const HumbleRangeMessage humble = WithoutVariance(range);
  EXPECT_STREQ(humble.header.frame_id, "r/sonar_0");
  EXPECT_EQ(humble.range, 1.5F);
  EXPECT_EQ(humble.max_range, 4.0F);
}

TEST(OdomInMap, ClosesTheChainFromTheMapToTheRobot) {
  const Pose X_WR{3.0, -2.0, 0.25, 1.0};
  const Pose estimate{0.5, 0.25, 0.0, -0.5};
  LocalizationDescription odometry;
  odometry.type = LocalizationType::kOdometry;
  const Pose chain = OdomInMap(odometry, X_WR, estimate) * estimate;
  EXPECT_NEAR(chain.x, X_WR.x, 1e-12);
  EXPECT_NEAR(chain.y, X_WR.y, 1e-12);
  EXPECT_NEAR(chain.z, X_WR.z, 1e-12);
  EXPECT_NEAR(chain.heading, X_WR.heading, 1e-12);
  EXPECT_EQ(OdomInMap(LocalizationDescription{}, X_WR, X_WR), Pose{});
}

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
  const RangeScan scan{
      {.fan = {2.0, 2}, .elevations = {-0.5, 0.25}, .limits = {0.0, 9.0}}, {1.0, 9.0, 9.0, 2.0}, {0.5, 0.0, 0.0, 1.0}};
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
  EXPECT_EQ(result.pose.covariance[0], kMinVariance);
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

using testing::HasSubstr;

TEST(MakeMap, MarksOccupiedCells) {
  OccupancyGrid grid{
      .resolution = 0.25, .origin_x = -1.0, .origin_y = -2.0, .width = 2, .height = 1, .occupied = {true, false}};
  dds::WireArena arena;
  const OccupancyGridMessage map = MakeMap(grid, arena);
  EXPECT_STREQ(map.header.frame_id, "map");
  EXPECT_EQ(map.info.resolution, 0.25F);
  EXPECT_EQ(map.info.width, 2u);
  EXPECT_EQ(map.info.height, 1u);
  EXPECT_EQ(map.info.origin.position.x, -1.0);
  EXPECT_EQ(map.info.origin.position.y, -2.0);
  EXPECT_EQ(map.info.origin.orientation.w, 1.0);
  EXPECT_THAT(dds::Elements(map.data), ElementsAre(100, 0));
}

TEST(MakeBlockMarkers, DrawsEveryBlockAsAClosedSolidInItsFrame) {
  SmallWorld world;
  world.AddBox("wall", 5.0, 0.0, 2.0, 1.0, {0.0, 0.5});
  world.AddRobot("r", {1.0, 1.0, 0.0, 0.0});
  dds::WireArena arena;
  const MarkerArray message = MakeBlockMarkers(Scene(world.world()), {{"r/base_link"}}, arena);
  const auto markers = dds::Elements(message.markers);
  ASSERT_EQ(markers.size(), 2u);
  EXPECT_STREQ(markers[0].header.frame_id, "map");
  EXPECT_FALSE(markers[0].frame_locked);
  EXPECT_STREQ(markers[1].header.frame_id, "r/base_link");
  EXPECT_TRUE(markers[1].frame_locked);
  EXPECT_NE(markers[0].id, markers[1].id);
  for (const Marker& marker : markers) {
    EXPECT_EQ(marker.type, 11);
    EXPECT_EQ(marker.scale.x, 1.0);
    EXPECT_EQ(marker.pose.orientation.w, 1.0);
    // The signed volumes of the cones from the origin over an outward-facing closed surface add up to that of the
    // solid.
    double volume = 0.0;
    const auto points = dds::Elements(marker.points);
    ASSERT_EQ(points.size(), 36u);
    for (std::size_t i = 0; i < points.size(); i += 3) {
      const auto &a = points[i], &b = points[i + 1], &c = points[i + 2];
      volume += (a.x * (b.y * c.z - b.z * c.y) - a.y * (b.x * c.z - b.z * c.x) + a.z * (b.x * c.y - b.y * c.x)) / 6.0;
    }
    EXPECT_NEAR(volume, &marker == &markers[0] ? 1.0 : 0.064, 1e-9);
  }
}

TEST(MakePointCloud, HasAPointForEachSensorWithAHit) {
  dds::WireArena arena;
  const PointCloud2 cloud = MakePointCloud({}, "r/base_link", {{0.5, 0.0, 0.25, 0.0}, {0.0, 0.5, 0.25, kPi / 2}},
                                           {1.0, 4.0}, {4.0, 4.0}, arena);
  EXPECT_EQ(cloud.width, 1u);
  EXPECT_EQ(cloud.height, 1u);
  EXPECT_EQ(cloud.point_step, 12u);
  EXPECT_EQ(cloud.row_step, 12u);
  ASSERT_EQ(cloud.data._length, 12u);
  float point[3];
  std::memcpy(point, cloud.data._buffer, sizeof point);
  EXPECT_THAT(point, ElementsAre(1.5F, 0.0F, 0.25F));
  ASSERT_EQ(cloud.fields._length, 3u);
  EXPECT_STREQ(cloud.fields._buffer[2].name, "z");
  EXPECT_EQ(cloud.fields._buffer[2].offset, 8u);
  EXPECT_EQ(cloud.fields._buffer[2].datatype, 7);
  EXPECT_EQ(MakePointCloud({}, "f", {}, {}, {}, arena).data._length, 0u);
}

TEST(MakeJointState, NamesEachJoint) {
  dds::WireArena arena;
  const JointStateMessage message = MakeJointState({3, 0}, {{"lift", {0.25, -0.5, false}}}, arena);
  EXPECT_EQ(message.header.stamp.sec, 3);
  EXPECT_STREQ(message.name._buffer[0], "lift");
  EXPECT_THAT(dds::Elements(message.position), ElementsAre(0.25));
  EXPECT_THAT(dds::Elements(message.velocity), ElementsAre(-0.5));
  EXPECT_EQ(message.effort._length, 0u);
}

TEST(MakeRobotDescription, IsUrdfWithTheFramesOfTheRobot) {
  SmallWorld world;
  const RobotId robot = world.AddRobot("a<b", {});
  world.AddRanger(robot, {0.1, 0.0, 0.3, 0.0}, {Fan(1.0, 5)});
  const std::string urdf = MakeRobotDescription(Scene(world.world()), robot, "a_b", FramesOf("a_b", true));
  EXPECT_THAT(urdf, HasSubstr("<robot name=\"a_b\">"));
  EXPECT_THAT(urdf, HasSubstr("<link name=\"a_b/base_link\">"));
  EXPECT_THAT(urdf, HasSubstr("<origin xyz=\"0 0 0.2\" rpy=\"0 0 0\"/><geometry><box size=\"0.4 0.4 0.4\"/>"));
  EXPECT_THAT(urdf, HasSubstr("<parent link=\"a_b/base_link\"/><child link=\"a_b/scan\"/><origin xyz=\"0.1 0 0.3\""));
}

}  // namespace
}  // namespace troupe::ros
