#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros/messages/convert.h"
#include "ros/messages/robot_frames.h"
#include "tests/support/small_world.h"

namespace troupe::ros {
namespace {

using testing::ElementsAre;
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
