// Reader: reads an MCAP file, chunk by chunk in any order. A file without its end, as left by a process that was
// killed, is read up to its last whole chunk; so is one whose summary is damaged.
//
// Any bytes are safe: sizes are checked before memory is allocated for them. What the system cannot read is no damage:
// it is an error of every function, with the reason.
//
// Limits: messages outside chunks, attachments and metadata are skipped; chunks have to be compressed with zstd, or
// not.
//
// Open reads the header and the summary alone, so that a long recording opens at once; a chunk is read and decompressed
// when it is asked for. Without a usable summary the whole file is scanned, and every chunk checked.
//
// A reader is constant after Open: several threads may read chunks.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "recording/mcap/byte_stream.h"
#include "recording/mcap/format.h"
#include "troupe/result.h"

namespace troupe::mcap {

// The place from which on a file is not readable.
struct Damage {
  std::uint64_t offset = 0;
  std::string problem;
};

struct Chunk {
  std::vector<std::byte> records;
  std::vector<Message> messages;  // in file order; their data is in `records`
};

class Reader {
 public:
  // The error is a file that is no MCAP file, or one of the system. With a code other than kBadInput it begins like
  // one.
  static Result<Reader> Open(std::unique_ptr<const ByteSource> source);

  const std::string& name() const { return source_->name(); }
  std::uint64_t size() const { return source_->size(); }
  const std::string& profile() const { return profile_; }
  const std::string& library() const { return library_; }
  // The schemas by their ids.
  const std::map<std::uint16_t, Schema>& schemas() const { return schemas_; }
  const std::map<std::uint16_t, Channel>& channels() const { return channels_; }
  // In file order.
  const std::vector<ChunkInfo>& chunks() const { return chunks_; }
  // Nothing if the file has none.
  const std::optional<Statistics>& statistics() const { return statistics_; }
  // Nothing for a file with a whole summary; its chunks may be damaged all the same.
  const std::optional<Damage>& damage() const { return damage_; }

  // Reads chunk `index` of chunks(). The error is a damaged chunk, or one of the system. REQUIRES: index <
  // chunks().size()
  Result<Chunk> ReadChunk(std::size_t index) const;
  // The part up to the last chunk of which all indices are whole, too. The error is one of the system.
  Result<WrittenPart> ReadWrittenPart() const;
  // Compares the bytes before the summary with their CRC. The error is a difference, or one of the system. Success
  // without a CRC.
  Status CheckData() const;

 private:
  struct Record {
    std::uint8_t opcode = 0;
    std::uint64_t offset = 0;  // of the record
    std::uint64_t length = 0;  // of its content
    std::uint64_t content() const { return offset + kRecordHeader; }
    std::uint64_t end() const { return content() + length; }
  };

  explicit Reader(std::unique_ptr<const ByteSource> source) : source_(std::move(source)) {}

  Error ErrorAt(std::uint64_t offset, const std::string& problem) const;
  Error Unreadable(const std::system_error& failure) const;
  // All functions below throw std::system_error as ByteSource does; their errors are damage.
  Result<std::vector<std::byte>> ReadBytes(std::uint64_t offset, std::uint64_t count) const;
  // The record at `offset`, which ends before `end`.
  Result<Record> ReadRecord(std::uint64_t offset, std::uint64_t end) const;
  // The indices behind the chunk; nothing if they are not whole. Adds their messages to the statistics.
  std::optional<IndexedChunk> ReadIndices(const ChunkInfo& info, Statistics& statistics) const;
  std::uint32_t CrcUntil(std::uint64_t end) const;
  Status ReadHeader();
  Status ReadSummary();
  Status ParseSummary(std::span<const std::byte> bytes, std::uint64_t offset);
  // Reads the file from the header on, up to its end or the first damage.
  void Scan();
  // Reads a record of the data section; false at its end.
  Result<bool> ScanRecord(const Record& record);
  Status ParseChannelOrSchema(std::uint8_t opcode, std::span<const std::byte> content, std::uint64_t offset);
  Result<ChunkInfo> ReadChunkInfo(const Record& record, std::uint32_t& crc, std::uint64_t& records) const;
  Result<Chunk> ReadChunk(const ChunkInfo& info, Reader* definitions) const;

  std::unique_ptr<const ByteSource> source_;
  std::string profile_;
  std::string library_;
  std::uint64_t data_start_ = 0;           // offset behind the header
  std::optional<std::uint64_t> data_end_;  // of the record DataEnd
  std::uint32_t data_crc_ = 0;             // 0: none
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::vector<ChunkInfo> chunks_;
  std::optional<Statistics> statistics_;
  std::optional<Damage> damage_;
};

}  // namespace troupe::mcap
