// The user data with which ROS marks an endpoint.
#pragma once

#include <string>

#include "common/dds/binding/qos.h"
#include "common/dds/binding/topic.h"
#include "common/ros_dds/type_hash.h"

namespace troupe::ros {

template <typename T>
dds::UserData TypeUserData(Distribution distribution) {
  return {TypeMark(distribution, dds::TopicTraits<T>::descriptor()->m_typename)};
}

// By `id` a client recognizes the two endpoints of one service.
template <typename T>
dds::UserData ServiceUserData(Distribution distribution, const std::string& id) {
  return {"serviceid=" + id + ";" + TypeUserData<T>(distribution).bytes};
}

}  // namespace troupe::ros
