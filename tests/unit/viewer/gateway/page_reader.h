// PageReader: reads the messages for the page, as viewer/web/src/protocol.ts does.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/bytes.h"
#include "troupe/world_state.h"

namespace troupe::test {

class PageReader : public ByteReader {
 public:
  using ByteReader::ByteReader;
  ~PageReader() { EXPECT_TRUE(ok()) << "the message ends early"; }

  std::uint8_t ReadByte() { return Read<std::uint8_t>(); }
  std::uint32_t ReadCount() { return Read<std::uint32_t>(); }
  std::int32_t ReadIndex() { return Read<std::int32_t>(); }
  double ReadDouble() { return Read<double>(); }
  float ReadFloat() { return Read<float>(); }
  Pose ReadPose() { return {.x = ReadDouble(), .y = ReadDouble(), .z = ReadDouble(), .heading = ReadDouble()}; }
  void ReadInto(Pose& pose) { pose = ReadPose(); }
  void ReadInto(Twist& twist) { twist = {ReadFloat(), ReadFloat(), ReadFloat()}; }
  void ReadInto(double& number) { number = ReadDouble(); }
  void ReadInto(std::uint32_t& number) { number = ReadCount(); }
  void ReadInto(std::uint64_t& number) { number = Read<std::uint64_t>(); }
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
};

}  // namespace troupe::test
