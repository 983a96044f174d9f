#include "ros/connection/find_topic_type.h"

#include <map>

#include "ros/connection/topic_types.h"

namespace troupe::ros {
namespace {

using Types = std::map<std::string, const dds_topic_descriptor_t*>;

Types UsualTypes() {
  Types types;
#define TROUPE_ROS_TYPE(type) types[type##_desc.m_typename] = dds::TopicTraits<type>::descriptor();
  TROUPE_ROS_TYPES(TROUPE_ROS_TYPE)
#undef TROUPE_ROS_TYPE
  return types;
}

Types HumbleTypes() {
  Types types = UsualTypes();
  for (const dds_topic_descriptor_t* type :
       {dds::TopicTraits<humble_sensor_msgs_msg_dds__Range_>::descriptor(),
        dds::TopicTraits<humble_rmw_dds_common_msg_dds__ParticipantEntitiesInfo_>::descriptor()}) {
    types[type->m_typename] = type;
  }
  return types;
}

}  // namespace

const dds_topic_descriptor_t* FindTopicType(const std::string& name, Distribution distribution) {
  static const Types usual = UsualTypes();
  static const Types humble = HumbleTypes();
  const Types& types = distribution == Distribution::kHumble ? humble : usual;
  const auto found = types.find(name);
  return found != types.end() ? found->second : nullptr;
}

}  // namespace troupe::ros
