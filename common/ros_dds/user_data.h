// The user data with which ROS marks an endpoint. From Iron on it has the hash of the endpoint's type; these
// distributions warn of an endpoint without one, once for each command. Humble knows no hashes.
#pragma once

#include <string>

#include "common/dds/binding/qos.h"
#include "common/dds/binding/topic.h"
#include "common/ros/ros_options.h"
#include "common/ros_dds/type_hash.h"

namespace troupe::ros {

template <typename T>
dds::UserData TypeUserData(Distribution distribution) {
  if (distribution == Distribution::kHumble) return {""};
  return {"typehash=" + TypeHash(dds::TopicTraits<T>::descriptor()->m_typename) + ";"};
}

// By `id` a client recognizes the two endpoints of one service.
template <typename T>
dds::UserData ServiceUserData(Distribution distribution, const std::string& id) {
  return {"serviceid=" + id + ";" + TypeUserData<T>(distribution).bytes};
}

}  // namespace troupe::ros
