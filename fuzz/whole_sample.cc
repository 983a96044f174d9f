#include "fuzz/whole_sample.h"

#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/q_protocol.h>

#include <cstdint>
#include <cstring>

namespace troupe::fuzz {
namespace {

constexpr std::size_t kHeaderSize = 4;
constexpr std::size_t kZeros = 1024;  // bytes

}  // namespace

std::vector<std::byte> WholeSample(Bytes bytes, const dds_topic_descriptor_t& descriptor) {
  std::vector<std::byte> own(bytes.begin(), bytes.end());
  if (own.size() < kHeaderSize) return own;
  const std::size_t size = own.size() - kHeaderSize + kZeros;
  std::vector<std::uint64_t> copy(size / sizeof(std::uint64_t) + 1);
  std::memcpy(copy.data(), own.data() + kHeaderSize, own.size() - kHeaderSize);
  std::uint32_t used = 0;
  const bool swap = own[1] == std::byte{0};
  const std::uint32_t* end =
      dds_stream_normalize_data(reinterpret_cast<char*>(copy.data()), &used, static_cast<std::uint32_t>(size), swap,
                                CDR_ENC_VERSION_1, descriptor.m_ops);
  if (end == nullptr) return own;
  own.resize(kHeaderSize + used);
  own[3] = std::byte{0};  // no padding
  return own;
}

}  // namespace troupe::fuzz
