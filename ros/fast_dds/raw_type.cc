#include "ros/fast_dds/raw_type.h"

#include <cstring>

namespace troupe::ros {
namespace {

constexpr std::uint32_t kUsualSize = 256;

}  // namespace

RawType::RawType(const std::string& name) {
  setName(name.c_str());
  m_typeSize = kUsualSize;
  m_isGetKeyDefined = false;
  // Cyclone DDS 0.10 cannot parse announcements with descriptions of types.
  auto_fill_type_object(false);
  auto_fill_type_information(false);
}

bool RawType::serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) {
  const Bytes& bytes = *static_cast<const Bytes*>(data);
  if (bytes.size() > payload->max_size || bytes.size() < 2) return false;
  std::memcpy(payload->data, bytes.data(), bytes.size());
  payload->length = static_cast<std::uint32_t>(bytes.size());
  payload->encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
  return true;
}

bool RawType::deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) {
  static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
  return true;
}

std::function<std::uint32_t()> RawType::getSerializedSizeProvider(void* data) {
  return [data] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size()); };
}

}  // namespace troupe::ros
