// SampleBuffer<T>: samples in memory of the program's own that each take() reuses. At a high rate of samples this saves
// the time to allocate and free the sequences of a loan.
#pragma once

#include <dds/dds.h>

#include <array>
#include <cstddef>

#include "transport/dds/binding/loaned_samples.h"
#include "transport/dds/binding/topic.h"

namespace troupe::dds {

template <typename T>
class SampleBuffer {
 public:
  static constexpr std::size_t kCapacity = 2;

  SampleBuffer() {
    for (std::size_t i = 0; i < kCapacity; ++i) data_[i] = &samples_[i];
  }
  ~SampleBuffer() { clear(); }
  SampleBuffer(const SampleBuffer&) = delete;
  SampleBuffer& operator=(const SampleBuffer&) = delete;

  std::size_t length() const { return count_; }
  // More samples may be waiting in the reader.
  bool full() const { return count_ == kCapacity; }
  const T& data(std::size_t index) const { return samples_[index]; }
  SampleInfo info(std::size_t index) const { return SampleInfo(infos_[index]); }

  // Removes the samples and frees their memory.
  void clear() {
    for (T& sample : samples_) {
      dds_sample_free(&sample, TopicTraits<T>::descriptor(), DDS_FREE_CONTENTS);
      sample = T{};
    }
    count_ = 0;
  }

  // Replaces the samples by up to kCapacity others, which are removed from the reader. For DataReader.
  void FillFrom(dds_entity_t reader) {
    const auto result = dds_take(reader, data_.data(), infos_.data(), kCapacity, kCapacity);
    count_ = result > 0 ? static_cast<std::size_t>(result) : 0;
    Check(result, "taking samples");
  }

 private:
  std::array<T, kCapacity> samples_{};
  std::array<void*, kCapacity> data_{};
  std::array<dds_sample_info_t, kCapacity> infos_{};
  std::size_t count_ = 0;
};

}  // namespace troupe::dds
