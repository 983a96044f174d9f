#include "ros/messages/names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <string>
#include <utility>
#include <vector>

#include "ros/connection/topic_types.h"
#include "ros/connection/type_descriptions.h"
#include "ros/messages/ros_options.h"
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

TEST(DescribeType, ListsFieldsAndAllTypesInIt) {
  const std::vector<DescribedType> types = DescribeType("geometry_msgs/msg/TwistStamped");
  std::vector<std::string> names;
  for (const DescribedType& type : types) names.push_back(type.name);
  EXPECT_THAT(names,
              testing::ElementsAre("geometry_msgs/msg/TwistStamped", "builtin_interfaces/msg/Time",
                                   "geometry_msgs/msg/Twist", "geometry_msgs/msg/Vector3", "std_msgs/msg/Header"));
  ASSERT_EQ(types.front().fields.size(), 2u);
  EXPECT_EQ(types.front().fields[0].name, "header");
  EXPECT_EQ(types.front().fields[0].type, 1) << "nested";
  EXPECT_EQ(types.front().fields[0].nested_type, "std_msgs/msg/Header");
}

TEST(DescribeType, HasTheCapacitiesOfArrays) {
  const std::vector<DescribedType> types = DescribeType("geometry_msgs/msg/PoseWithCovariance");
  ASSERT_FALSE(types.empty());
  const DescribedField& covariance = types.front().fields.back();
  EXPECT_EQ(covariance.name, "covariance");
  EXPECT_EQ(covariance.type, 11 + 48) << "an array of float64";
  EXPECT_EQ(covariance.capacity, 36u);
}

TEST(DescribeType, KnowsNoOtherTypes) {
  for (const char* name : {"", "x", "std_msgs/msg/NoSuch", "std_msgs/msg/String data", "a\nb"}) {
    EXPECT_TRUE(DescribeType(name).empty()) << name;
  }
}

TEST(TypeHash, IsThatOfJazzy) {
  EXPECT_EQ(RosTypeName("std_msgs::msg::dds_::String_"), "std_msgs/msg/String");
  EXPECT_THAT(TypeHash("std_msgs::msg::dds_::String_"), testing::StartsWith("RIHS01_df668c740482bbd4"));
  EXPECT_THAT(TypeHash("geometry_msgs::msg::dds_::Twist_"), testing::StartsWith("RIHS01_9c45bf16fe0983d8"));
  EXPECT_EQ(TypeHash("geometry_msgs::msg::dds_::Twist_").size(), 7u + 64u);
}

TEST(TypeHash, IsInTheUserDataOfEndpointsFromIronOn) {
  const std::string mark = TypeMark(Distribution::kJazzy, "std_msgs::msg::dds_::String_");
  EXPECT_EQ(mark, "typehash=" + TypeHash("std_msgs::msg::dds_::String_") + ";");
  EXPECT_EQ(TypeMark(Distribution::kHumble, "std_msgs::msg::dds_::String_"), "");
}

TEST(TypeHash, EndpointsOfServicesHaveThatOfTheServiceFromLyricalOn) {
  const std::string request = "std_srvs::srv::dds_::SetBool_Request_";
  const std::string mark = "typehash=" + TypeHash(request) + ";";
  EXPECT_EQ(TypeMark(Distribution::kKilted, request), mark);
  for (const Distribution distribution : {Distribution::kLyrical, Distribution::kRolling}) {
    EXPECT_EQ(TypeMark(distribution, request), mark + "sertypehash=" + HashOfRosType("std_srvs/srv/SetBool") + ";");
    EXPECT_THAT(TypeMark(distribution, "control_msgs::action::dds_::GripperCommand_SendGoal_Response_"),
                testing::HasSubstr("sertypehash=RIHS01_6bf8cc4c"));
    EXPECT_THAT(TypeMark(distribution, "std_msgs::msg::dds_::String_"), testing::Not(testing::HasSubstr("sertype")));
  }
}

TEST(TypeHash, IsEmptyForATypeUnknownToRos) {
  for (const char* name : {"", "troupe::wire::Frame", "std_msgs::msg::dds_::NoSuch_", "dds_::", "::dds_::x"}) {
    EXPECT_EQ(TypeHash(name), "") << name;
  }
}

template <typename T>
std::string NameOnDds() {
  return dds::TopicTraits<T>::descriptor()->m_typename;
}

TEST(TopicTypes, HaveTheNamesAndHashesOfRos) {
  for (const std::string& name :
       {NameOnDds<Bool>(), NameOnDds<String>(), NameOnDds<Clock>(), NameOnDds<TwistMessage>(),
        NameOnDds<TwistStamped>(), NameOnDds<TfMessage>(), NameOnDds<OdometryMessage>(),
        NameOnDds<OccupancyGridMessage>(), NameOnDds<LaserScan>(), NameOnDds<RangeMessage>(), NameOnDds<PointCloud2>(),
        NameOnDds<JointStateMessage>(), NameOnDds<BatteryState>(), NameOnDds<ImuMessage>(), NameOnDds<MarkerArray>(),
        NameOnDds<rmw_dds_common_msg_dds__ParticipantEntitiesInfo_>()}) {
    EXPECT_NE(TypeHash(name), "") << name;
  }
  EXPECT_EQ(NameOnDds<HumbleRangeMessage>(), NameOnDds<RangeMessage>());
  EXPECT_EQ(NameOnDds<humble_rmw_dds_common_msg_dds__ParticipantEntitiesInfo_>(),
            NameOnDds<rmw_dds_common_msg_dds__ParticipantEntitiesInfo_>());
}

TEST(FindTopicType, HasTheLayoutOfTheDistribution) {
  const char* const range = "sensor_msgs::msg::dds_::Range_";
  EXPECT_EQ(FindTopicType(range, Distribution::kHumble),
            dds::TopicTraits<humble_sensor_msgs_msg_dds__Range_>::descriptor());
  EXPECT_EQ(FindTopicType(range, Distribution::kJazzy), dds::TopicTraits<RangeMessage>::descriptor());
  using Usual = simulation_interfaces_srv_dds__SetEntityState_Request_;
  using Rolling = rolling_simulation_interfaces_srv_dds__SetEntityState_Request_;
  EXPECT_EQ(FindTopicType(NameOnDds<Usual>(), Distribution::kJazzy), dds::TopicTraits<Usual>::descriptor());
  EXPECT_EQ(FindTopicType(NameOnDds<Usual>(), Distribution::kKilted), dds::TopicTraits<Usual>::descriptor());
  EXPECT_EQ(FindTopicType(NameOnDds<Usual>(), Distribution::kLyrical), dds::TopicTraits<Rolling>::descriptor());
  EXPECT_EQ(FindTopicType(NameOnDds<Usual>(), Distribution::kRolling), dds::TopicTraits<Rolling>::descriptor());
  EXPECT_EQ(FindTopicType("x", Distribution::kJazzy), nullptr);
}

class RosEnvironment : public testing::Test {
 protected:
  void SetUp() override { Clear(); }
  void TearDown() override { Clear(); }
  void Clear() {
    for (const char* name : {"ROS_DOMAIN_ID", "ROS_DISTRO", "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE",
                             "ROS_STATIC_PEERS", "ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY",
                             "ROS_SECURITY_KEYSTORE", "ROS_SECURITY_ENCLAVE_OVERRIDE", "RMW_IMPLEMENTATION"}) {
      unsetenv(name);
    }
  }
};

TEST_F(RosEnvironment, GivesTheDefaultsOfRos) {
  EXPECT_EQ(OptionsFromEnvironment().network.domain, 0u);
  EXPECT_EQ(OptionsFromEnvironment().network.distribution, Distribution::kJazzy);
  EXPECT_EQ(OptionsFromEnvironment().network.network_interface, "auto");
  EXPECT_EQ(OptionsFromEnvironment().network.discovery, DiscoveryRange::kSubnet);
}

TEST_F(RosEnvironment, SetsTheOptions) {
  setenv("ROS_DOMAIN_ID", "17", 1);
  setenv("ROS_DISTRO", "humble", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.domain, 17u);
  EXPECT_EQ(OptionsFromEnvironment().network.distribution, Distribution::kHumble);
  setenv("ROS_DISTRO", "lyrical", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.distribution, Distribution::kLyrical);
}

TEST_F(RosEnvironment, SetsTheRangeOfDiscovery) {
  const std::pair<const char*, DiscoveryRange> ranges[] = {
      {"OFF", DiscoveryRange::kOff},
      {"LOCALHOST", DiscoveryRange::kLocalhost},
      {"SUBNET", DiscoveryRange::kSubnet},
      {"SYSTEM_DEFAULT", DiscoveryRange::kSystemDefault},
      {"ELSEWHERE", DiscoveryRange::kLocalhost},  // as in ROS
  };
  setenv("ROS_STATIC_PEERS", "one;;10.0.0.2", 1);
  for (const auto& [name, range] : ranges) {
    setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", name, 1);
    EXPECT_EQ(OptionsFromEnvironment().network.discovery, range) << name;
  }
  EXPECT_EQ(OptionsFromEnvironment().network.static_peers, (std::vector<std::string>{"one", "10.0.0.2"}));
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET", 1);
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.discovery, DiscoveryRange::kSubnet);
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.discovery, DiscoveryRange::kLocalhost);
  EXPECT_TRUE(OptionsFromEnvironment().network.static_peers.empty());
}

TEST_F(RosEnvironment, NamesValuesThatAreNotValid) {
  for (const std::string domain : {"x", "17x", "-1", "231", "99999999999", "0x", "08"}) {
    setenv("ROS_DOMAIN_ID", domain.c_str(), 1);
    EXPECT_EQ(OptionsFromEnvironment().faults.domain,
              "ROS_DOMAIN_ID: found '" + domain + "', expected a number from 0 to 230");
  }
  setenv("ROS_DISTRO", "noetic", 1);
  EXPECT_EQ(OptionsFromEnvironment().faults.distribution,
            "ROS_DISTRO: found 'noetic', expected humble, iron, jazzy, kilted, lyrical or rolling (--ros-distro "
            "overrides it)");
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCAL", 1);
  EXPECT_NE(OptionsFromEnvironment().faults.discovery, "");
}

TEST_F(RosEnvironment, NamesAnRmwWhoseProgramsDoNotFindTheRun) {
  for (const char* rmw : {"", "rmw_cyclonedds_cpp", "rmw_fastrtps_cpp", "rmw_fastrtps_dynamic_cpp"}) {
    setenv("RMW_IMPLEMENTATION", rmw, 1);
    EXPECT_EQ(OptionsFromEnvironment().faults.rmw, "") << rmw;
  }
  setenv("RMW_IMPLEMENTATION", "rmw_zenoh_cpp", 1);
  EXPECT_EQ(OptionsFromEnvironment().faults.rmw,
            "RMW_IMPLEMENTATION: found 'rmw_zenoh_cpp', expected rmw_cyclonedds_cpp or rmw_fastrtps_cpp: programs on "
            "another one do not find this run");
}

TEST_F(RosEnvironment, ReadsADomainAsRosDoes) {
  for (const auto& [text, domain] : {std::pair{"", 0U}, {"0", 0U}, {"230", 230U}, {"0x11", 17U}, {"021", 17U}}) {
    setenv("ROS_DOMAIN_ID", text, 1);
    EXPECT_EQ(OptionsFromEnvironment().network.domain, domain) << text;
    EXPECT_EQ(OptionsFromEnvironment().faults.domain, "") << text;
  }
}

TEST_F(RosEnvironment, HasNoSecurityUnlessItIsEnabled) {
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kOff);
  setenv("ROS_SECURITY_STRATEGY", "Enforce", 1);
  setenv("ROS_SECURITY_ENABLE", "false", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kOff);
  EXPECT_EQ(OptionsFromEnvironment().network.security.fault, "");
  const Result<Enclave> none = FindEnclave(OptionsFromEnvironment().network.security, "/world");
  ASSERT_TRUE(none.ok());
  EXPECT_EQ(none.value().name, "/");
  EXPECT_EQ(none.value().folder, "");
}

TEST_F(RosEnvironment, SetsTheSecurity) {
  setenv("ROS_SECURITY_ENABLE", "true", 1);
  setenv("ROS_SECURITY_KEYSTORE", "/keys", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kPermissive);
  EXPECT_EQ(OptionsFromEnvironment().network.security.keystore, "/keys");
  setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", "/swarm", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.enclave, "/swarm");
  EXPECT_EQ(FindEnclave(OptionsFromEnvironment().network.security, "/r0").value().name, "/swarm");
  setenv("ROS_SECURITY_STRATEGY", "Permissive", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kPermissive);
  setenv("ROS_SECURITY_STRATEGY", "Enforce", 1);
  EXPECT_EQ(OptionsFromEnvironment().network.security.strategy, SecurityStrategy::kEnforce);
}

TEST(RosNetwork, FastDdsServesNeitherSecuredRunsNorHiddenOnes) {
  RosNetwork network;
  EXPECT_EQ(UsesFastDds(network), HasFastDds());
  network.service_clients = ServiceClients::kCyclone;
  EXPECT_FALSE(UsesFastDds(network));
  network.service_clients = ServiceClients::kBoth;
  EXPECT_EQ(UsesFastDds(network), HasFastDds());
  network.discovery = DiscoveryRange::kOff;
  EXPECT_FALSE(UsesFastDds(network));
  network.discovery = DiscoveryRange::kSubnet;
  network.security.strategy = SecurityStrategy::kPermissive;
  EXPECT_FALSE(UsesFastDds(network));
}

TEST_F(RosEnvironment, ABadValueOfSecurityIsAnError) {
  setenv("ROS_SECURITY_ENABLE", "yes", 1);
  EXPECT_EQ(FindEnclave(OptionsFromEnvironment().network.security, "/world").error().message,
            "ROS_SECURITY_ENABLE: found 'yes', expected true or false");
  setenv("ROS_SECURITY_ENABLE", "true", 1);
  setenv("ROS_SECURITY_STRATEGY", "enforce", 1);
  EXPECT_EQ(FindEnclave(OptionsFromEnvironment().network.security, "/world").error().message,
            "ROS_SECURITY_STRATEGY: found 'enforce', expected Enforce or Permissive");
}

TEST_F(RosEnvironment, MissingKeysAreAnErrorOrAWarning) {
  RosSecurity security{SecurityStrategy::kEnforce, "/no/such/folder", {}, {}};
  EXPECT_EQ(
      FindEnclave(security, "/r0").error().ToString(),
      "/no/such/folder/enclaves/r0: error: found no such folder, expected the keys of a participant (enclave /r0 of "
      "ROS 2)");
  security.strategy = SecurityStrategy::kPermissive;
  const Result<Enclave> open = FindEnclave(security, "/r0");
  ASSERT_TRUE(open.ok());
  EXPECT_EQ(open.value().folder, "");
  EXPECT_NE(open.value().warning.find("continuing without security"), std::string::npos);
  security.keystore.clear();
  EXPECT_NE(FindEnclave(security, "/r0").value().warning.find("ROS_SECURITY_KEYSTORE"), std::string::npos);
}

}  // namespace
}  // namespace troupe::ros
