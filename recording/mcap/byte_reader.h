// ByteReader: reads the values of MCAP records from bytes of unknown origin. After a value that does not fit into the
// bytes, ok() is false and all values are empty.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace troupe::mcap {

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  bool at_end() const { return bytes_.empty(); }
  std::size_t remaining() const { return bytes_.size(); }

  template <typename Integer>
  Integer Read() {
    Integer value = 0;
    const std::span<const std::byte> bytes = ReadBytes(sizeof value);
    if (ok_) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  std::span<const std::byte> ReadBytes(std::uint64_t count) {
    if (count > bytes_.size()) {
      ok_ = false;
      bytes_ = {};
      return {};
    }
    const std::span<const std::byte> bytes = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return bytes;
  }
  // Bytes behind their length.
  template <typename Length>
  std::span<const std::byte> ReadWithLength() {
    return ReadBytes(Read<Length>());
  }
  std::string ReadText() {
    const std::span<const std::byte> bytes = ReadWithLength<std::uint32_t>();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

}  // namespace troupe::mcap
