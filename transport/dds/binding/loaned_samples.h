// LoanedSamples<T>: samples that a reader lends; its destructor returns them. Move-only; must not outlive its reader.
//
// Two ways to receive. A loan gives samples in memory of Cyclone without a copy into memory of the program, for rare
// topics; a SampleBuffer reuses its own memory from take to take, for the topics of each tick.
#pragma once

#include <dds/dds.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"

namespace troupe::dds {

// The state of a sample and its instance.
class SampleInfo {
 public:
  SampleInfo() = default;
  explicit SampleInfo(const dds_sample_info_t& info) : info_(info) {}

  // False: the sample only reports a change of the instance's state, and only the key fields of its data are valid.
  bool valid() const { return info_.valid_data; }
  // The instance was disposed, or no live writer is left.
  bool instance_alive() const { return info_.instance_state == DDS_IST_ALIVE; }
  bool instance_disposed() const { return info_.instance_state == DDS_IST_NOT_ALIVE_DISPOSED; }
  dds_instance_handle_t instance_handle() const { return info_.instance_handle; }
  dds_instance_handle_t publication_handle() const { return info_.publication_handle; }
  dds_time_t source_timestamp() const { return info_.source_timestamp; }  // when it was written, by the writer's clock

 private:
  dds_sample_info_t info_{};
};

template <typename T>
class LoanedSamples {
 public:
  static constexpr std::size_t kMaxSamples = 16;

  class Sample {
   public:
    Sample(const T& data, const dds_sample_info_t& info) : data_(data), info_(info) {}
    const T& data() const { return data_; }
    SampleInfo info() const { return SampleInfo(info_); }

   private:
    const T& data_;
    const dds_sample_info_t& info_;
  };

  class Iterator {
   public:
    Iterator(const LoanedSamples& samples, std::size_t index) : samples_(samples), index_(index) {}
    Sample operator*() const { return samples_[index_]; }
    Iterator& operator++() {
      ++index_;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return index_ != other.index_; }

   private:
    const LoanedSamples& samples_;
    std::size_t index_;
  };

  // Owns `count` samples that `reader` lent. For DataReader.
  using Data = std::array<void*, kMaxSamples>;
  using Infos = std::array<dds_sample_info_t, kMaxSamples>;
  LoanedSamples(dds_entity_t reader, const Data& data, const Infos& infos, std::size_t count)
      : reader_(reader), data_(data), infos_(infos), count_(count) {}
  LoanedSamples(LoanedSamples&& other) noexcept
      : reader_(other.reader_), data_(other.data_), infos_(other.infos_), count_(std::exchange(other.count_, 0)) {}
  LoanedSamples& operator=(LoanedSamples&&) = delete;
  ~LoanedSamples() {
    if (count_ > 0) dds_return_loan(reader_, data_.data(), static_cast<std::int32_t>(count_));
  }

  std::size_t length() const { return count_; }
  bool empty() const { return count_ == 0; }
  Sample operator[](std::size_t index) const { return Sample(*static_cast<const T*>(data_[index]), infos_[index]); }
  Iterator begin() const { return Iterator(*this, 0); }
  Iterator end() const { return Iterator(*this, count_); }

 private:
  dds_entity_t reader_;
  Data data_;
  Infos infos_;
  std::size_t count_;
};

// Loans a reader's next samples, at most kMaxSamples. `function`: dds_take, which removes them, or dds_read. Throws
// Exception.
template <typename T, typename Function>
LoanedSamples<T> Loan(dds_entity_t reader, Function function, const char* doing) {
  typename LoanedSamples<T>::Data data{};  // a null pointer first asks for a loan
  typename LoanedSamples<T>::Infos infos;
  const auto size = static_cast<std::uint32_t>(data.size());
  const auto count = Check(function(reader, data.data(), infos.data(), size, size), doing);
  return LoanedSamples<T>(reader, data, infos, static_cast<std::size_t>(count));
}

// SampleBuffer<T>: samples in memory of the program's own that each take() reuses. At a high rate of samples this saves
// the time to allocate and free the sequences of a loan.
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
