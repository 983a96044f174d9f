// RawType: a DDS type whose samples are the serialized bytes themselves, whatever their layout: this side does not look
// into messages.
#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <string>

#include "ros/fast_dds/call_header.h"

namespace troupe::ros {

class RawType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  // `name`: of the type on DDS. Its samples are Bytes, with the 4 bytes that state the encoding.
  explicit RawType(const std::string& name);

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override { return new Bytes(); }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace troupe::ros
