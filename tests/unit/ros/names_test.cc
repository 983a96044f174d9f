#include "ros/messages/names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"

namespace troupe::ros {
namespace {

using testing::ElementsAre;

TEST(RosName, KeepsOnlyCharactersThatRosAllows) {
  EXPECT_EQ(RosName("anna"), "anna");
  EXPECT_EQ(RosName("position:0"), "position_0");
  EXPECT_EQ(RosName("a b--c__d_"), "a_b_c_d");
  EXPECT_EQ(RosName("_x"), "x");
  EXPECT_EQ(RosName("7up"), "n7up");
  EXPECT_EQ(RosName("\xc3\xa4"), "unnamed");
  EXPECT_EQ(RosName(""), "unnamed");
}

TEST(RobotNames, StayDistinctWhenRosNamesCollide) {
  SmallWorld world;
  for (const char* name : {"r:0", "r_0", "r-0", "r_0_1"}) world.AddRobot(name, {});
  EXPECT_THAT(RobotNames(world.world()), ElementsAre("r_0_2", "r_0", "r_0_3", "r_0_1"));
}

TEST(FramesOf, HaveThePrefixOfTheRobotIfAsked) {
  EXPECT_EQ(FramesOf("anna", true).base, "anna/base_link");
  EXPECT_EQ(FramesOf("anna", true).odom, "anna/odom");
  EXPECT_EQ(FramesOf("anna", false).base, "base_link");
  EXPECT_EQ(FramesOf("anna", false).prefix, "");
}

TEST(SensorTopicsOf, NamesUnnamedScannersScanAndRingsSonar) {
  SmallWorld world;
  const RobotId robot = world.AddRobot("r", {});
  world.AddRanger(robot, {}, {OneRay(), OneRay()});
  world.AddRanger(robot, {}, {Fan(1.0, 5)});
  world.AddRanger(robot, {}, {Fan(1.0, 5)});
  world.AddRanger(robot, {}, {OneRay()});
  world.AddRanger(robot, {}, {Fan(1.0, 5)});
  world.robot(robot).sensors.back().name = "front laser";
  const SensorTopics topics = SensorTopicsOf(world.robot(robot));
  ASSERT_EQ(topics.lasers.size(), 3u);
  EXPECT_EQ(topics.lasers[0].topic, "scan");
  EXPECT_EQ(topics.lasers[0].ranger, 1u);
  EXPECT_EQ(topics.lasers[1].topic, "scan_1");
  EXPECT_EQ(topics.lasers[2].topic, "front_laser");
  ASSERT_EQ(topics.sonars.size(), 2u);
  EXPECT_EQ(topics.sonars[0].topic, "sonar");
  EXPECT_EQ(topics.sonars[0].sensors.size(), 2u);
  EXPECT_EQ(topics.sonars[1].topic, "sonar_1");
}

TEST(SensorTopicsOf, NamesOtherKindsByTheirTypes) {
  SmallWorld world;
  const RobotId robot = world.AddRobot("r", {});
  RaySensorDescription scanner = Fan(1.0, 5);
  scanner.elevations = {-0.1, 0.1};
  world.AddRanger(robot, {}, {scanner});
  for (SensorParameters parameters : {SensorParameters(CameraParameters()), SensorParameters(CameraParameters()),
                                      SensorParameters(BumperParameters()), SensorParameters(ContactParameters()),
                                      SensorParameters(FiducialParameters()), SensorParameters(BlobfinderParameters()),
                                      SensorParameters(FiducialParameters()), SensorParameters(ImuParameters())}) {
    test::AddSensor(world.world(), robot, {}, std::move(parameters));
  }
  world.robot(robot).sensors[2].name = "rear eye";
  const SensorTopics topics = SensorTopicsOf(world.robot(robot));
  EXPECT_TRUE(topics.lasers.empty());
  ASSERT_EQ(topics.clouds.size(), 1u);
  EXPECT_EQ(topics.clouds[0].topic, "scan");
  ASSERT_EQ(topics.cameras.size(), 2u);
  EXPECT_EQ(topics.cameras[0].topic, "camera");
  EXPECT_EQ(topics.cameras[0].frame, "camera");
  EXPECT_EQ(topics.cameras[1].topic, "rear_eye");
  ASSERT_EQ(topics.touches.size(), 2u);
  EXPECT_EQ(topics.touches[0].topic, "bumper");
  EXPECT_EQ(topics.touches[1].topic, "contact");
  EXPECT_EQ(topics.touches[1].sensor, 4u);
  ASSERT_EQ(topics.finders.size(), 2u);
  EXPECT_EQ(topics.finders[0].topic, "fiducial");
  EXPECT_EQ(topics.finders[0].frame, "fiducial");
  EXPECT_EQ(topics.finders[1].topic, "fiducial_1");
  EXPECT_EQ(topics.finders[1].sensor, 7u);
  ASSERT_EQ(topics.blobfinders.size(), 1u);
  EXPECT_EQ(topics.blobfinders[0].topic, "blobfinder");
  ASSERT_EQ(topics.imus.size(), 1u);
  EXPECT_EQ(topics.imus[0].topic, "imu");
  EXPECT_EQ(topics.imus[0].frame, "imu");
}

TEST(SensorTopicsOf, MakesFramesAndTopicsUnique) {
  SmallWorld world;
  const RobotId robot = world.AddRobot("r", {});
  for (int i = 0; i < 3; ++i) world.AddRanger(robot, {}, {OneRay(), OneRay(), Fan(1.0, 5)});
  for (const char* name : {"odom", "base_link", "scan", "scan_1", "cmd_vel", "map"}) {
    world.AddRanger(robot, {}, {Fan(1.0, 5)});
    world.robot(robot).sensors.back().name = name;
  }
  const SensorTopics topics = SensorTopicsOf(world.robot(robot));
  std::vector<std::string> frames = {"odom", "base_link", "map"};
  std::vector<std::string> names = {"odom", "cmd_vel"};
  for (const LaserTopic& laser : topics.lasers) {
    frames.push_back(laser.frame);
    names.push_back(laser.topic);
  }
  for (const SonarTopic& sonar : topics.sonars) {
    names.push_back(sonar.topic);
    for (const auto& sensor : sonar.sensors) frames.push_back(sensor.frame);
  }
  EXPECT_EQ(frames.size(), 3u + 9u + 6u);
  for (auto* list : {&frames, &names}) {
    std::sort(list->begin(), list->end());
    EXPECT_EQ(std::adjacent_find(list->begin(), list->end()), list->end());
  }
}

}  // namespace
}  // namespace troupe::ros
