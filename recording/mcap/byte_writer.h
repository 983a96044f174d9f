// ByteWriter: appends the values of MCAP records to a buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "recording/mcap/format.h"

namespace troupe::mcap {

class ByteWriter {
 public:
  // The buffer outlives the writer.
  explicit ByteWriter(std::vector<std::byte>& buffer) : buffer_(buffer) {}

  std::size_t size() const { return buffer_.size(); }

  // Little-endian, as all processors that Troupe runs on.
  template <typename Integer>
  void Add(Integer value) {
    Replace(Grow(sizeof value), value);
  }
  void Add(std::span<const std::byte> bytes) {
    const std::size_t at = Grow(bytes.size());
    if (!bytes.empty()) std::memcpy(buffer_.data() + at, bytes.data(), bytes.size());
  }
  void Add(std::string_view text) {
    Add(static_cast<std::uint32_t>(text.size()));
    Add(std::as_bytes(std::span(text)));
  }

  // Adds a record; `content` adds its values.
  template <typename Content>
  void AddRecord(Opcode opcode, const Content& content) {
    Add(static_cast<std::uint8_t>(opcode));
    AddWithLength<std::uint64_t>(content);
  }
  // Adds the length in bytes of the values that `content` adds, and these.
  template <typename Length, typename Content>
  void AddWithLength(const Content& content) {
    const std::size_t at = Grow(sizeof(Length));
    content();
    Replace(at, static_cast<Length>(buffer_.size() - at - sizeof(Length)));
  }

 private:
  std::size_t Grow(std::size_t count) {
    const std::size_t at = buffer_.size();
    buffer_.resize(at + count);
    return at;
  }
  template <typename Integer>
  void Replace(std::size_t at, Integer value) {
    std::memcpy(buffer_.data() + at, &value, sizeof value);
  }

  std::vector<std::byte>& buffer_;
};

}  // namespace troupe::mcap
