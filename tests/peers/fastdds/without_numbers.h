// WithoutNumbers<PubSubType>: a type of a request or a response as rmw_fastrtps lays it out. The generated types begin
// with the caller's two numbers, 16 bytes, because idl/ros has the layout of rmw_cyclonedds.
#pragma once

#include <cstring>
#include <fastdds/dds/topic/TopicDataType.hpp>

template <typename PubSubType>
class WithoutNumbers : public PubSubType {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

  bool serialize(void* data, Payload* payload) override {
    Payload whole(this->getSerializedSizeProvider(data)());
    if (!PubSubType::serialize(data, &whole)) return false;
    payload->length = whole.length - kNumbers;
    payload->encapsulation = whole.encapsulation;
    std::memcpy(payload->data, whole.data, kEncoding);
    std::memcpy(payload->data + kEncoding, whole.data + kEncoding + kNumbers, payload->length - kEncoding);
    return true;
  }
  bool deserialize(Payload* payload, void* data) override {
    if (payload->length < kEncoding) return false;
    Payload whole(payload->length + kNumbers);
    whole.length = payload->length + kNumbers;
    std::memcpy(whole.data, payload->data, kEncoding);
    std::memset(whole.data + kEncoding, 0, kNumbers);
    std::memcpy(whole.data + kEncoding + kNumbers, payload->data + kEncoding, payload->length - kEncoding);
    return PubSubType::deserialize(&whole, data);
  }

 private:
  static constexpr std::uint32_t kEncoding = 4;
  static constexpr std::uint32_t kNumbers = 16;
};
