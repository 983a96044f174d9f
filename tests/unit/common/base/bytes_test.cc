#include "common/base/bytes.h"

#include <gtest/gtest.h>

namespace troupe {
namespace {

TEST(BytesTest, ReadsBackWhatWasWritten) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  writer.Write(std::uint16_t{0x0102});
  writer.Write(-2.5);
  writer.WriteText("abc");
  writer.WriteWithLength<std::uint64_t>([&] { writer.Write(std::uint32_t{7}); });
  EXPECT_EQ(bytes[0], std::byte{2}) << "little-endian";
  ByteReader reader(bytes);
  EXPECT_EQ(reader.Read<std::uint16_t>(), 0x0102);
  EXPECT_EQ(reader.Read<double>(), -2.5);
  EXPECT_EQ(reader.ReadText(), "abc");
  EXPECT_EQ(ByteReader(reader.ReadWithLength<std::uint64_t>()).Read<std::uint32_t>(), 7u);
  EXPECT_TRUE(reader.ok());
  EXPECT_TRUE(reader.at_end());
}

TEST(BytesTest, WritesIntoTextsToo) {
  std::string text;
  ByteWriter writer(text);
  writer.Write(std::uint8_t{'x'});
  writer.WriteBytes("yz");
  EXPECT_EQ(text, "xyz");
  EXPECT_EQ(ByteReader(text).ReadRest(), "xyz");
}

TEST(BytesTest, AfterAValueThatDoesNotFitAllAreEmpty) {
  const std::string text(
      "\xff\xff\xff\xff"
      "abcd",
      8);
  ByteReader reader(text);
  EXPECT_EQ(reader.ReadText(), "");
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.Read<std::uint8_t>(), 0u);
  EXPECT_EQ(reader.ReadRest(), "");
}

}  // namespace
}  // namespace troupe
