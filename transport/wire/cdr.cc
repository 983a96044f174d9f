#include "transport/wire/cdr.h"

#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/q_protocol.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

namespace troupe::wire {
namespace {

static_assert(std::endian::native == std::endian::little, "samples are laid out as their bytes");

// The encapsulation header (RTPS 2.2, section 10.5): its second byte is the representation; the two lowest bits of the
// fourth one count the bytes of padding at the end.
constexpr std::size_t kHeaderSize = 4;
constexpr std::byte kBigEndianCdr{0};
constexpr std::byte kLittleEndianCdr{1};
constexpr std::size_t kAlignment = 4;

class OutputStream {
 public:
  OutputStream() { dds_ostreamLE_init(&stream_, 0, CDR_ENC_VERSION_1); }
  ~OutputStream() { dds_ostreamLE_fini(&stream_); }
  OutputStream(const OutputStream&) = delete;
  OutputStream& operator=(const OutputStream&) = delete;

  dds_ostreamLE_t* get() { return &stream_; }
  std::size_t size() const { return stream_.x.m_index; }
  const void* data() const { return stream_.x.m_buffer; }

 private:
  dds_ostreamLE_t stream_;
};

Error MalformedSample(const dds_topic_descriptor_t& descriptor, const std::string& problem) {
  return {{}, std::string("bytes of a ") + descriptor.m_typename + ": " + problem};
}

}  // namespace

std::vector<std::byte> SampleToCdr(const void* sample, const dds_topic_descriptor_t& descriptor) {
  OutputStream stream;
  const std::uint32_t* end = dds_stream_writeLE(stream.get(), static_cast<const char*>(sample), descriptor.m_ops);
  TROUPE_CHECK(end != nullptr);  // fails for values out of an enumeration or a bound only, and the types have neither
  const std::size_t padding = (kAlignment - stream.size() % kAlignment) % kAlignment;
  std::vector<std::byte> bytes(kHeaderSize + stream.size() + padding);
  bytes[1] = kLittleEndianCdr;
  bytes[3] = static_cast<std::byte>(padding);
  if (stream.size() > 0) std::memcpy(bytes.data() + kHeaderSize, stream.data(), stream.size());
  return bytes;
}

Status SampleFromCdr(std::span<const std::byte> bytes, const dds_topic_descriptor_t& descriptor, void* sample) {
  if (bytes.size() < kHeaderSize)
    return MalformedSample(descriptor, "found fewer than 4, expected an encapsulation header");
  const bool known = bytes[0] == std::byte{0} && (bytes[1] == kBigEndianCdr || bytes[1] == kLittleEndianCdr);
  if (!known) return MalformedSample(descriptor, "found another representation, expected plain CDR");
  const bool swap = bytes[1] == kBigEndianCdr;
  const std::size_t padding = std::to_integer<std::size_t>(bytes[3]) % kAlignment;
  bytes = bytes.subspan(kHeaderSize);
  if (padding > bytes.size()) return MalformedSample(descriptor, "found more padding than bytes");
  bytes = bytes.first(bytes.size() - padding);
  if (bytes.size() > std::numeric_limits<std::int32_t>::max())
    return MalformedSample(descriptor, "found more than 2 GiB");

  // A copy, because Cyclone checks and swaps in place; eight more bytes, so that it is never empty.
  std::vector<std::uint64_t> copy(bytes.size() / sizeof(std::uint64_t) + 1);
  if (!bytes.empty()) std::memcpy(copy.data(), bytes.data(), bytes.size());
  const auto size = static_cast<std::uint32_t>(bytes.size());
  std::uint32_t used = 0;
  const std::uint32_t* end = dds_stream_normalize_data(reinterpret_cast<char*>(copy.data()), &used, size, swap,
                                                       CDR_ENC_VERSION_1, descriptor.m_ops);
  if (end == nullptr)
    return MalformedSample(descriptor, "found one that ends early or has a field that makes no sense");
  if (used != size) return MalformedSample(descriptor, "found " + std::to_string(size - used) + " after its end");
  dds_istream_t stream;
  dds_istream_init(&stream, size, copy.data(), CDR_ENC_VERSION_1);
  dds_stream_read(&stream, static_cast<char*>(sample), descriptor.m_ops);
  return {};
}

}  // namespace troupe::wire
