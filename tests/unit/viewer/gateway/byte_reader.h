// ByteReader: reads the messages for the page, as viewer/web/src/protocol.ts does.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/world_state.h"

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
  Pose ReadPose() { return {.x = ReadDouble(), .y = ReadDouble(), .z = ReadDouble(), .heading = ReadDouble()}; }
  void ReadInto(Pose& pose) { pose = ReadPose(); }
  void ReadInto(Twist& twist) { twist = {ReadFloat(), ReadFloat(), ReadFloat()}; }
  void ReadInto(double& number) { number = ReadDouble(); }
  void ReadInto(std::uint32_t& number) { number = ReadCount(); }
  void ReadInto(bool& flag) { flag = ReadByte() != 0; }
  void ReadInto(ObjectMode& mode) { mode = static_cast<ObjectMode>(ReadByte()); }
  template <typename Tag>
  void ReadInto(std::optional<Id<Tag>>& id) {
    const std::int32_t index = ReadIndex();
    id = index < 0 ? std::nullopt : std::optional(Id<Tag>(static_cast<std::size_t>(index)));
  }
  // The rows that have changed, behind their numbers, which it returns.
  template <typename Row>
  std::vector<std::uint32_t> ReadRows(std::vector<Row>& rows) {
    std::vector<std::uint32_t> numbers(ReadCount());
    for (std::uint32_t& number : numbers) {
      number = ReadCount();
      if (number >= rows.size()) rows.resize(number + 1);
      ForEachField<Row>([&](const auto& field) { ReadInto(field.Of(rows[number])); });
    }
    return numbers;
  }
  bool at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

}  // namespace troupe::test
