// ByteWriter: appends numbers and texts, little-endian, to the bytes of a message for the page.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "troupe/pose.h"

namespace troupe {

static_assert(std::endian::native == std::endian::little, "messages are copies of numbers in memory");

class ByteWriter {
 public:
  template <typename Number>
  requires std::is_arithmetic_v<Number>
  void Write(Number value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    bytes_.append(bytes, sizeof value);
  }
  void WriteByte(bool value) { Write<std::uint8_t>(value ? 1 : 0); }
  void WriteCount(std::size_t count) { Write(static_cast<std::uint32_t>(count)); }
  void WriteFloat(double value) { Write(static_cast<float>(value)); }
  // The length in bytes, then UTF-8.
  void WriteText(std::string_view text) {
    WriteCount(text.size());
    bytes_.append(text);
  }
  // The index of an id, -1 for none.
  template <typename OptionalId>
  void WriteId(const OptionalId& id) {
    Write(id ? static_cast<std::int32_t>(id->index()) : std::int32_t{-1});
  }
  void WritePose(const Pose& pose) {
    Write(pose.x);
    Write(pose.y);
    Write(pose.z);
    Write(pose.heading);
  }
  void Append(std::string_view bytes) { bytes_.append(bytes); }

  // A count whose value is known later.
  std::size_t ReserveCount() {
    WriteCount(0);
    return bytes_.size() - sizeof(std::uint32_t);
  }
  void FillCount(std::size_t place, std::size_t count) {
    const auto value = static_cast<std::uint32_t>(count);
    std::memcpy(bytes_.data() + place, &value, sizeof value);
  }

  std::string TakeBytes() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace troupe
