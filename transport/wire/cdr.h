// CDR bytes of the types in idl/ without a participant: as they travel over DDS, for recordings, shared memory and
// tests. Little-endian XCDR1 behind the encapsulation header of RTPS (4 bytes), padded to a multiple of 4.
//
// Functions without state; any thread may call.
//
// Cyclone's own serializer does the work, with the descriptors that idlc has made, so that bytes here and on the
// network are the same; it checks any bytes before it reads them.
#pragma once

#include <dds/dds.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "transport/dds/binding/domain_participant.h"
#include "troupe/result.h"

namespace troupe::wire {

// A sample of an IDL type that owns its strings and sequences. Move-only.
template <typename Wire>
class Sample {
 public:
  Sample() = default;
  Sample(Sample&& other) noexcept : data_(std::exchange(other.data_, Wire{})) {}
  Sample& operator=(Sample&& other) noexcept {
    std::swap(data_, other.data_);
    return *this;
  }
  ~Sample() { dds_sample_free(&data_, dds::TopicTraits<Wire>::descriptor(), DDS_FREE_CONTENTS); }

  const Wire& data() const { return data_; }
  Wire& data() { return data_; }

 private:
  Wire data_{};
};

// Room for a sample of the type that `descriptor` describes, at first zero; owns its strings and sequences.
class UntypedSample {
 public:
  explicit UntypedSample(const dds_topic_descriptor_t& descriptor)
      : descriptor_(descriptor), room_(descriptor.m_size / sizeof(std::uint64_t) + 1) {}
  ~UntypedSample() { dds_sample_free(data(), &descriptor_, DDS_FREE_CONTENTS); }
  UntypedSample(const UntypedSample&) = delete;
  UntypedSample& operator=(const UntypedSample&) = delete;

  void* data() const { return room_.data(); }

 private:
  const dds_topic_descriptor_t& descriptor_;
  mutable std::vector<std::uint64_t> room_;  // aligned as the largest fields
};

// `sample`: of the type that `descriptor` describes.
std::vector<std::byte> SampleToCdr(const void* sample, const dds_topic_descriptor_t& descriptor);
// `sample`: of that type, and zero. An error, and `sample` unchanged, when the bytes are not a whole sample of it.
Status SampleFromCdr(std::span<const std::byte> bytes, const dds_topic_descriptor_t& descriptor, void* sample);

template <typename Wire>
std::vector<std::byte> ToCdr(const Wire& sample) {
  return SampleToCdr(&sample, *dds::TopicTraits<Wire>::descriptor());
}

// Any bytes are safe: an error if they are no sample.
template <typename Wire>
Result<Sample<Wire>> FromCdr(std::span<const std::byte> bytes) {
  Sample<Wire> sample;
  Status malformed = SampleFromCdr(bytes, *dds::TopicTraits<Wire>::descriptor(), &sample.data());
  if (!malformed.ok()) return malformed.error();
  return sample;
}

}  // namespace troupe::wire
