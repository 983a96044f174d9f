// The user data with which ROS marks an endpoint.
#pragma once

#include <string>

#include "ros/connection/type_hash.h"
#include "transport/dds/binding/qos.h"
#include "transport/dds/binding/topic.h"

namespace troupe::ros {

inline dds::UserData TypeUserData(Distribution distribution, const dds_topic_descriptor_t& type) {
  return {TypeMark(distribution, type.m_typename)};
}

template <typename T>
dds::UserData TypeUserData(Distribution distribution) {
  return TypeUserData(distribution, *dds::TopicTraits<T>::descriptor());
}

// By `id` a client recognizes the two endpoints of one service.
inline dds::UserData ServiceUserData(Distribution distribution, const std::string& id,
                                     const dds_topic_descriptor_t& type) {
  return {"serviceid=" + id + ";" + TypeUserData(distribution, type).bytes};
}

}  // namespace troupe::ros
