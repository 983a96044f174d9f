// ByteReader: reads the messages for the page, as viewer/web/src/protocol.ts does.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "troupe/pose.h"

namespace troupe::test {

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <typename Number>
  Number Read() {
    Number value{};
    EXPECT_GE(rest_.size(), sizeof value);
    if (rest_.size() < sizeof value) return value;
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  std::uint8_t ReadByte() { return Read<std::uint8_t>(); }
  std::uint32_t ReadCount() { return Read<std::uint32_t>(); }
  std::int32_t ReadIndex() { return Read<std::int32_t>(); }
  double ReadDouble() { return Read<double>(); }
  float ReadFloat() { return Read<float>(); }
  std::string ReadText() {
    const std::uint32_t size = ReadCount();
    EXPECT_GE(rest_.size(), size);
    std::string text(rest_.substr(0, size));
    rest_.remove_prefix(std::min<std::size_t>(size, rest_.size()));
    return text;
  }
  Pose ReadPose() {
    Pose pose;
    pose.x = ReadDouble();
    pose.y = ReadDouble();
    pose.z = ReadDouble();
    pose.heading = ReadDouble();
    return pose;
  }
  bool at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

}  // namespace troupe::test
