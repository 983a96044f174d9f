#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros/connection/topic_types.h"
#include "ros/connection/type_descriptions.h"

namespace troupe::ros {
namespace {

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

}  // namespace
}  // namespace troupe::ros
