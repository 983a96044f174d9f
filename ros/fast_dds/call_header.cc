#include "ros/fast_dds/call_header.h"

#include <cstddef>

namespace troupe::ros {
namespace {

constexpr std::size_t kEncoding = 4;
constexpr std::size_t kHeader = 16;

bool IsLittleEndian(std::span<const std::uint8_t> sample) {
  return sample[1] == 1;
}

void Append(Bytes& bytes, std::uint64_t value, bool little_endian) {
  for (unsigned i = 0; i < 8; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8U * (little_endian ? i : 7 - i)));
  }
}

std::uint64_t ReadNumber(std::span<const std::uint8_t> bytes, bool little_endian) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < 8; ++i) value |= std::uint64_t{bytes[i]} << 8U * (little_endian ? i : 7 - i);
  return value;
}

}  // namespace

bool IsPlainCdr(std::span<const std::uint8_t> sample) {
  return sample.size() >= kEncoding && sample[0] == 0 && sample[1] <= 1;
}

// The header is a multiple of 8 bytes, so that no value behind it changes its alignment.
std::optional<Bytes> WithHeader(std::span<const std::uint8_t> sample, const CallHeader& header) {
  if (!IsPlainCdr(sample)) return std::nullopt;
  const bool little_endian = IsLittleEndian(sample);
  Bytes bytes;
  bytes.reserve(sample.size() + kHeader);
  bytes.assign(sample.begin(), sample.begin() + kEncoding);
  Append(bytes, header.client_guid, little_endian);
  Append(bytes, static_cast<std::uint64_t>(header.sequence_number), little_endian);
  bytes.insert(bytes.end(), sample.begin() + kEncoding, sample.end());
  return bytes;
}

std::optional<HeadedSample> SplitHeader(std::span<const std::uint8_t> sample) {
  if (!IsPlainCdr(sample) || sample.size() < kEncoding + kHeader) return std::nullopt;
  const bool little_endian = IsLittleEndian(sample);
  HeadedSample split;
  split.header.client_guid = ReadNumber(sample.subspan(kEncoding), little_endian);
  split.header.sequence_number = static_cast<std::int64_t>(ReadNumber(sample.subspan(kEncoding + 8), little_endian));
  split.sample.assign(sample.begin(), sample.begin() + kEncoding);
  split.sample.insert(split.sample.end(), sample.begin() + kEncoding + kHeader, sample.end());
  return split;
}

}  // namespace troupe::ros
