// The identity of an endpoint as Fast DDS has it.
#pragma once

#include <fastdds/rtps/common/Guid.h>

#include <algorithm>

#include "ros/service_bridge/guid.h"

namespace troupe::ros {

inline Guid ToGuid(const eprosima::fastrtps::rtps::GUID_t& guid) {
  Guid bytes;
  std::copy(guid.guidPrefix.value, guid.guidPrefix.value + 12, bytes.begin());
  std::copy(guid.entityId.value, guid.entityId.value + 4, bytes.begin() + 12);
  return bytes;
}

inline eprosima::fastrtps::rtps::GUID_t FromGuid(const Guid& bytes) {
  eprosima::fastrtps::rtps::GUID_t guid;
  std::copy(bytes.begin(), bytes.begin() + 12, guid.guidPrefix.value);
  std::copy(bytes.begin() + 12, bytes.end(), guid.entityId.value);
  return guid;
}

}  // namespace troupe::ros
