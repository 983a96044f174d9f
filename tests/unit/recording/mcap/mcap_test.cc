#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <random>
#include <string>
#include <system_error>

#include "recording/mcap/bytes.h"
#include "recording/mcap/reader.h"
#include "recording/mcap/writer.h"
#include "tests/support/values.h"

namespace troupe::mcap {
namespace {

using ::testing::HasSubstr;

struct Content {
  std::uint16_t channel = 0;
  std::uint64_t log_time = 0;
  std::string data;
  bool operator==(const Content&) const = default;
};
using Contents = std::vector<Content>;

std::span<const std::byte> BytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}

// Two channels; a chunk for each element of `chunks`.
std::vector<std::byte> Write(const std::vector<Contents>& chunks) {
  std::vector<std::byte> bytes;
  Writer writer = Writer::Create(MakeMemorySink(bytes), "profile", "library").value();
  const std::uint16_t schema = writer.AddSchema({"a::Type", "omgidl", "struct Type {};"});
  writer.AddChannel({schema, "/first", "cdr", {{"key", "value"}}});
  writer.AddChannel({0, "/second", "text"});
  std::uint32_t sequence = 0;
  for (const Contents& chunk : chunks) {
    for (const Content& content : chunk) {
      writer.Add({content.channel, sequence++, content.log_time, content.log_time + 1, BytesOf(content.data)});
    }
    EXPECT_TRUE(writer.EndChunk().ok());
  }
  EXPECT_TRUE(writer.Close().ok());
  return bytes;
}

Result<Reader> Open(std::span<const std::byte> bytes) {
  return Reader::Open(MakeMemorySource("test.mcap", bytes));
}

Contents ContentsOf(const Chunk& chunk) {
  Contents contents;
  for (const Message& message : chunk.messages) {
    EXPECT_EQ(message.publish_time, message.log_time + 1);
    contents.push_back(
        {message.channel, message.log_time, {reinterpret_cast<const char*>(message.data.data()), message.data.size()}});
  }
  return contents;
}

// The chunks up to the first that cannot be read.
std::vector<Contents> ReadAll(const Reader& reader, bool& whole) {
  std::vector<Contents> chunks;
  whole = !reader.damage();
  for (std::size_t i = 0; i < reader.chunks().size(); ++i) {
    const Result<Chunk> chunk = reader.ReadChunk(i);
    if (!chunk.ok()) {
      EXPECT_FALSE(chunk.error().message.empty());
      whole = false;
      break;
    }
    chunks.push_back(ContentsOf(chunk.value()));
  }
  return chunks;
}

const std::vector<Contents>& Small() {
  static const std::vector<Contents> chunks = {
      {{0, 10, "one"}, {1, 20, ""}}, {{1, 20, std::string(300, 'x')}}, {{0, 30, "three"}, {0, 30, "four"}}};
  return chunks;
}

TEST(Mcap, ReturnsWhatWasWritten) {
  const std::vector<std::byte> bytes = Write(Small());
  const Reader reader = test::ValueOf(Open(bytes));
  EXPECT_FALSE(reader.damage());
  EXPECT_EQ(reader.profile(), "profile");
  EXPECT_EQ(reader.library(), "library");
  EXPECT_EQ(reader.schemas().at(1), (Schema{"a::Type", "omgidl", "struct Type {};"}));
  EXPECT_EQ(reader.channels().at(0), (Channel{1, "/first", "cdr", {{"key", "value"}}}));
  EXPECT_EQ(reader.channels().at(1), (Channel{0, "/second", "text"}));
  ASSERT_EQ(reader.chunks().size(), 3u);
  EXPECT_EQ(reader.chunks()[0].channels, (std::vector<std::uint16_t>{0, 1}));
  EXPECT_EQ(reader.chunks()[1].channels, (std::vector<std::uint16_t>{1}));
  EXPECT_EQ(reader.chunks()[0].start_time, 10u);
  EXPECT_EQ(reader.chunks()[0].end_time, 20u);
  EXPECT_EQ(reader.statistics(), (Statistics{5, 10, 30, {{0, 3}, {1, 2}}}));
  EXPECT_TRUE(reader.CheckData().ok());
  bool whole = false;
  EXPECT_EQ(ReadAll(reader, whole), Small());
  EXPECT_TRUE(whole);
}

TEST(Mcap, ReturnsRandomMessages) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 50; ++round) {
    std::vector<Contents> chunks(random() % 5);
    for (Contents& chunk : chunks) {
      chunk.resize(1 + random() % 20);
      for (Content& content : chunk) {
        content = {static_cast<std::uint16_t>(random() % 2), random() % 1000, std::string(random() % 2000, 'a')};
        for (char& c : content.data) c = static_cast<char>(random());
      }
    }
    const std::vector<std::byte> bytes = Write(chunks);
    const Reader reader = test::ValueOf(Open(bytes));
    bool whole = false;
    EXPECT_EQ(ReadAll(reader, whole), chunks);
    EXPECT_TRUE(whole);
  }
}

TEST(Mcap, ReadsACutOffFileUpToItsLastWholeChunk) {
  const std::vector<std::byte> bytes = Write(Small());
  const Reader complete = std::move(Open(bytes)).value();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    SCOPED_TRACE(size);
    const Result<Reader> reader = Open(std::span(bytes).first(size));
    if (!reader.ok()) {
      EXPECT_LT(size, complete.chunks().front().offset);
      continue;
    }
    ASSERT_TRUE(reader.value().damage());
    std::vector<Contents> expected;
    for (std::size_t i = 0; i < Small().size(); ++i) {
      const ChunkInfo& chunk = complete.chunks()[i];
      if (chunk.offset + chunk.length <= size) expected.push_back(Small()[i]);
    }
    bool whole = true;
    EXPECT_EQ(ReadAll(reader.value(), whole), expected);
    EXPECT_FALSE(whole);
  }
}

// A file on a disk that cannot read the bytes from `fault` on.
class FaultySource final : public ByteSource {
 public:
  FaultySource(std::span<const std::byte> bytes, std::uint64_t fault)
      : file_(MakeMemorySource("test.mcap", bytes)), fault_(fault) {}
  const std::string& name() const override { return file_->name(); }
  std::uint64_t size() const override { return file_->size(); }
  void Read(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset + bytes.size() > fault_) throw std::system_error(EIO, std::generic_category(), "cannot read");
    file_->Read(offset, bytes);
  }

 private:
  std::unique_ptr<const ByteSource> file_;
  std::uint64_t fault_;
};

TEST(Mcap, WhatTheSystemCannotReadIsNoDamage) {
  const std::vector<std::byte> whole = Write(Small());
  const std::vector<std::byte> cut(whole.begin(), whole.end() - 10);  // so that all of it is read at first
  for (const std::vector<std::byte>& bytes : {whole, cut}) {
    for (std::uint64_t fault = 0; fault < bytes.size(); ++fault) {
      const Result<Reader> reader = Reader::Open(std::make_unique<FaultySource>(bytes, fault));
      ASSERT_FALSE(reader.ok()) << fault;
      EXPECT_EQ(reader.error().ToString(), "test.mcap: error: cannot read: Input/output error");
    }
  }
}

TEST(Mcap, EveryDamageHasItsOwnName) {
  std::vector<std::byte> bytes = Write(Small());
  const std::uint64_t second = std::move(Open(bytes)).value().chunks()[1].offset;
  const auto problem = [&] { return std::move(Open(bytes)).value().damage().value().problem; };
  bytes[bytes.size() - 1] ^= std::byte{1};  // so that the summary is not used
  EXPECT_THAT(problem(), HasSubstr("the summary is missing or damaged"));
  bytes[second] = std::byte{0x7f};
  EXPECT_THAT(problem(), HasSubstr("found a record of type 127"));
  bytes.resize(second + 5);
  EXPECT_THAT(problem(), HasSubstr("the file is cut off: its " + std::to_string(second + 5) + " bytes end"));
}

TEST(Mcap, NeverReturnsOtherMessagesAfterAnyChangedBit) {
  std::vector<std::byte> bytes = Write(Small());
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    SCOPED_TRACE(bit);
    const std::byte mask = std::byte{1} << (bit % 8);
    bytes[bit / 8] ^= mask;
    if (const Result<Reader> reader = Open(bytes); reader.ok()) {
      bool whole = false;
      const std::vector<Contents> chunks = ReadAll(reader.value(), whole);
      ASSERT_LE(chunks.size(), Small().size());
      EXPECT_TRUE(std::equal(chunks.begin(), chunks.end(), Small().begin()));
      // What the chunks do not show, the CRC of the data does.
      if (whole) {
        EXPECT_EQ(chunks, Small());
        EXPECT_FALSE(reader.value().CheckData().ok());
      }
    }
    bytes[bit / 8] ^= mask;
  }
}

TEST(Mcap, ReadsAnyBytesWithoutACrash) {
  const std::vector<std::byte> bytes = Write(Small());
  std::mt19937_64 random(2);
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::byte> changed = bytes;
    for (std::size_t i = 0; i < 1 + random() % 4; ++i) {
      // Numbers of sizes and offsets are the most dangerous.
      const std::size_t at = random() % changed.size();
      const std::size_t count = std::min<std::size_t>(1 + random() % 8, changed.size() - at);
      for (std::size_t j = 0; j < count; ++j) changed[at + j] = random() % 2 == 0 ? std::byte{0xff} : std::byte{0};
    }
    const Result<Reader> reader = Open(changed);
    if (!reader.ok()) continue;
    bool whole = false;
    static_cast<void>(ReadAll(reader.value(), whole));
    static_cast<void>(reader.value().CheckData());
  }
}

TEST(Mcap, RefusesOtherFiles) {
  const std::string text = "{\"troupe\":\"0.1.0\"}\n";
  const Result<Reader> reader = Open(BytesOf(text));
  ASSERT_FALSE(reader.ok());
  EXPECT_EQ(reader.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(reader.error().message, HasSubstr("expected an MCAP file"));
  EXPECT_THAT(Open({}).error().message, HasSubstr("empty"));
}

TEST(Mcap, ReadsUncompressedChunksThatDefineTheirChannels) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  const auto text = [&](std::string_view value) { out.WriteText(value); };
  out.WriteBytes(kMagic);
  WriteRecord(out, Opcode::kHeader, [&] { text(""), text(""); });
  std::vector<std::byte> records;
  ByteWriter chunk(records);
  WriteRecord(chunk, Opcode::kChannel, [&] {
    chunk.Write(std::uint16_t{7});
    chunk.Write(std::uint16_t{0});
    chunk.WriteText("/topic");
    chunk.WriteText("json");
    chunk.Write(std::uint32_t{0});
  });
  WriteRecord(chunk, Opcode::kMessage, [&] {
    chunk.Write(std::uint16_t{7});
    chunk.Write(std::uint32_t{0});
    chunk.Write(std::uint64_t{5});
    chunk.Write(std::uint64_t{6});
    chunk.WriteBytes(BytesOf("{}"));
  });
  WriteRecord(out, Opcode::kChunk, [&] {
    out.Write(std::uint64_t{5});
    out.Write(std::uint64_t{5});
    out.Write(std::uint64_t{records.size()});
    out.Write(std::uint32_t{0});
    text("");
    out.WriteWithLength<std::uint64_t>([&] { out.WriteBytes(records); });
  });
  const Reader reader = test::ValueOf(Open(bytes));
  EXPECT_TRUE(reader.damage()) << "it has no end";
  EXPECT_EQ(reader.channels().at(7).topic, "/topic");
  bool whole = false;
  EXPECT_EQ(ReadAll(reader, whole), (std::vector<Contents>{{{7, 5, "{}"}}}));
}

// Fails after some bytes, as a disk that is full.
class FullSink final : public ByteSink {
 public:
  explicit FullSink(std::size_t room) : room_(room) {}
  Status Write(std::span<const std::byte> bytes) override {
    if (bytes.size() > room_) return Error{{"disk"}, "no space", ErrorCode::kOutputFailed};
    room_ -= bytes.size();
    return {};
  }
  Status Close() override { return {}; }

 private:
  std::size_t room_;
};

TEST(Mcap, ReportsAFullDisk) {
  EXPECT_FALSE(Writer::Create(std::make_unique<FullSink>(10), "", "").ok());
  Writer writer = Writer::Create(std::make_unique<FullSink>(200), "", "").value();
  const std::uint16_t channel = writer.AddChannel({0, "/topic", "text"});
  const std::string data = "data";
  for (int i = 0; i < 100; ++i) {
    writer.Add({channel, 0, 0, 0, BytesOf(data)});
    if (Status failure = writer.EndChunk(); !failure.ok()) {
      EXPECT_EQ(failure.error().message, "no space");
      EXPECT_FALSE(writer.Close().ok());
      return;
    }
  }
  ADD_FAILURE() << "no error";
}

}  // namespace
}  // namespace troupe::mcap
