#include "ros/connection/topic_types.h"

#include <cstddef>
#include <initializer_list>
#include <map>
#include <set>
#include <string_view>

namespace troupe::ros {
namespace {

using Types = std::map<std::string, const dds_topic_descriptor_t*>;

// With the layouts of a distribution in place of the usual ones.
Types TypesWith(std::initializer_list<const dds_topic_descriptor_t*> others) {
  Types types;
#define TROUPE_TYPE(type) types[type##_desc.m_typename] = dds::TopicTraits<type>::descriptor();
  TROUPE_ROS_TYPES(TROUPE_TYPE)
  TROUPE_SIMULATION_TYPES(TROUPE_TYPE)
#undef TROUPE_TYPE
  for (const dds_topic_descriptor_t* type : others) types[type->m_typename] = type;
  return types;
}

// REQUIRES: T is a struct of C, whose first member stands at its begin.
template <typename T>
constexpr bool HasHeaderFirst() {
  if constexpr (requires(T message) { message.header.stamp.nanosec; }) return offsetof(T, header) == 0;
  return false;
}

}  // namespace

bool BeginsWithHeader(const dds_topic_descriptor_t& type) {
  static const std::set<std::string_view> names = [] {
    std::set<std::string_view> found;
#define TROUPE_TYPE(type_of_list) \
  if (HasHeaderFirst<type_of_list>()) found.insert(type_of_list##_desc.m_typename);
    TROUPE_ROS_TYPES(TROUPE_TYPE)
#undef TROUPE_TYPE
    return found;
  }();
  return names.contains(type.m_typename);
}

const dds_topic_descriptor_t* FindTopicType(const std::string& name, Distribution distribution) {
  static const Types usual = TypesWith({});
  static const Types humble =
      TypesWith({dds::TopicTraits<humble_sensor_msgs_msg_dds__Range_>::descriptor(),
                 dds::TopicTraits<humble_rmw_dds_common_msg_dds__ParticipantEntitiesInfo_>::descriptor()});
  // The types of Open-RMF in Kilted and later.
  const dds_topic_descriptor_t* const fleet =
      dds::TopicTraits<kilted_rmf_fleet_msgs_msg_dds__FleetState_>::descriptor();
  const dds_topic_descriptor_t* const mode =
      dds::TopicTraits<kilted_rmf_fleet_msgs_msg_dds__ModeRequest_>::descriptor();
  const dds_topic_descriptor_t* const robot =
      dds::TopicTraits<kilted_rmf_fleet_msgs_msg_dds__RobotState_>::descriptor();
  static const Types kilted = TypesWith({fleet, mode, robot});
  static const Types rolling =
      TypesWith({fleet, mode, robot,
                 dds::TopicTraits<rolling_simulation_interfaces_srv_dds__SetEntityState_Request_>::descriptor(),
                 dds::TopicTraits<rolling_simulation_interfaces_srv_dds__GetSpawnables_Response_>::descriptor()});
  const Types& types = distribution == Distribution::kHumble    ? humble
                       : HasSimulationInterfaces2(distribution) ? rolling
                       : distribution == Distribution::kKilted  ? kilted
                                                                : usual;
  const auto found = types.find(name);
  return found != types.end() ? found->second : nullptr;
}

}  // namespace troupe::ros
