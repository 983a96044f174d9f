// The records of MCAP files (https://mcap.dev/spec), as far as Troupe writes and reads them. Integers are
// little-endian.
//
// Only values: reader.h reads them and writer.h writes them. Names follow the specification. Troupe
// writes messages in chunks, their indices, and a summary; it reads files of others with the same parts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::mcap {

// First and last in every file.
inline constexpr std::array<std::byte, 8> kMagic = {std::byte{0x89}, std::byte{'M'}, std::byte{'C'},  std::byte{'A'},
                                                    std::byte{'P'},  std::byte{'0'}, std::byte{'\r'}, std::byte{'\n'}};

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};
inline constexpr auto kLastOpcode = Opcode::kDataEnd;
inline constexpr std::uint8_t kFirstPrivateOpcode = 0x80;  // records of applications, which readers skip

inline constexpr std::size_t kRecordHeader = 9;  // bytes: opcode and length
inline constexpr std::size_t kFooterLength = 20;
inline constexpr std::size_t kDataEndLength = 4;

// The compression of the records in a chunk. Others are not supported.
inline constexpr const char* kZstd = "zstd";
inline constexpr const char* kUncompressed = "";

struct Schema {
  std::string name;
  std::string encoding;
  std::string data;
  bool operator==(const Schema&) const = default;
};

struct Channel {
  std::uint16_t schema = 0;  // 0: none
  std::string topic;
  std::string message_encoding;
  std::map<std::string, std::string> metadata = {};
  bool operator==(const Channel&) const = default;
};

struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;      // ns
  std::uint64_t publish_time = 0;  // ns
  std::span<const std::byte> data;
};

struct ChunkInfo {
  std::uint64_t offset = 0;      // of its record in the file
  std::uint64_t length = 0;      // of its record
  std::uint64_t start_time = 0;  // least and greatest log time, ns
  std::uint64_t end_time = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
  std::vector<std::uint16_t> channels;  // that have messages in it, ascending
  bool operator==(const ChunkInfo&) const = default;
};

// A chunk and the indices of its messages, one for each of its channels.
struct IndexedChunk {
  ChunkInfo info;
  std::map<std::uint16_t, std::uint64_t> index_offsets;  // of the MessageIndex records in the file, by channel
  std::uint64_t index_length = 0;                        // bytes of all of them
};

struct Statistics {
  std::uint64_t messages = 0;
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::map<std::uint16_t, std::uint64_t> channel_messages;
  bool operator==(const Statistics&) const = default;
};

// The start of a file up to a chunk with its indices, after which writing can continue.
struct WrittenPart {
  std::uint64_t size = 0;  // bytes
  std::uint32_t crc = 0;   // of these
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  std::vector<IndexedChunk> chunks;
  Statistics statistics;
};

}  // namespace troupe::mcap
