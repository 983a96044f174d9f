// Reading an MCAP file of unknown origin. The summary at the end is a shortcut: it is believed only if its place, its
// CRC and its indices fit the file; else the data are scanned from the start, as far as they are whole. A file that a
// killed service left ends in the middle of a record and is read by such a scan.
//
// Offsets and lengths come from the file: each is compared with what remains, by subtraction, since a sum of two of
// them could overflow. Memory is taken for one chunk at a time, of at most kMaxChunk bytes.
#include "recording/mcap/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/text.h"
#include "recording/mcap/bytes.h"

namespace troupe::mcap {
namespace {

constexpr std::uint64_t kFooterRecord = kRecordHeader + kFooterLength;
constexpr std::uint64_t kDataEndRecord = kRecordHeader + kDataEndLength;
// The bytes of a chunk before its records: two times, two sizes, a CRC, and two lengths.
constexpr std::uint64_t kChunkFields = 4 * sizeof(std::uint64_t) + 2 * sizeof(std::uint32_t) + sizeof(std::uint64_t);
constexpr std::uint64_t kMaxCompression = 64;                // bytes of its name
constexpr std::uint64_t kMaxChunk = std::uint64_t{1} << 30;  // bytes, decompressed
constexpr std::uint64_t kReadSize = std::uint64_t{1} << 20;  // bytes at a time for a CRC

bool IsKnown(std::uint8_t opcode) {
  return (opcode != 0 && opcode <= static_cast<std::uint8_t>(kLastOpcode)) || opcode >= kFirstPrivateOpcode;
}

bool Is(std::uint8_t opcode, Opcode expected) {
  return opcode == static_cast<std::uint8_t>(expected);
}

std::map<std::uint16_t, std::uint64_t> ReadMap(ByteReader& reader) {
  std::map<std::uint16_t, std::uint64_t> map;
  ByteReader entries(reader.ReadWithLength<std::uint32_t>());
  while (entries.ok() && !entries.at_end()) {
    const auto key = entries.Read<std::uint16_t>();
    map[key] = entries.Read<std::uint64_t>();
  }
  if (!entries.ok()) static_cast<void>(reader.ReadBytes(reader.remaining() + 1));  // fails
  return map;
}

ChunkInfo ParseChunkIndex(ByteReader& reader) {
  ChunkInfo info;
  info.start_time = reader.Read<std::uint64_t>();
  info.end_time = reader.Read<std::uint64_t>();
  info.offset = reader.Read<std::uint64_t>();
  info.length = reader.Read<std::uint64_t>();
  for (const auto& [channel, offset] : ReadMap(reader)) info.channels.push_back(channel);
  static_cast<void>(reader.Read<std::uint64_t>());  // the length of the message indices
  info.compression = reader.ReadText();
  info.compressed_size = reader.Read<std::uint64_t>();
  info.uncompressed_size = reader.Read<std::uint64_t>();
  return info;
}

Statistics ParseStatistics(ByteReader& reader) {
  Statistics statistics;
  statistics.messages = reader.Read<std::uint64_t>();
  static_cast<void>(reader.ReadBytes(sizeof(std::uint16_t) + 4 * sizeof(std::uint32_t)));  // counts of records
  statistics.start_time = reader.Read<std::uint64_t>();
  statistics.end_time = reader.Read<std::uint64_t>();
  statistics.channel_messages = ReadMap(reader);
  return statistics;
}

}  // namespace

Error Reader::ErrorAt(std::uint64_t offset, const std::string& problem) const {
  return {{name()}, fmt::format("byte {}: {}", offset, problem), ErrorCode::kFailure};
}

Error Reader::Unreadable(const std::system_error& failure) const {
  return {{name()}, failure.what(), ErrorCode::kFailure};
}

Result<Reader> Reader::Open(std::unique_ptr<const ByteSource> source) {
  Reader reader(std::move(source));
  try {
    if (Status failure = reader.ReadHeader(); !failure.ok()) return failure.error();
    // Whatever is wrong with the summary, the data may be whole: it is forgotten, and the file scanned.
    if (reader.ReadSummary().ok()) return reader;
    reader.schemas_.clear();
    reader.channels_.clear();
    reader.chunks_.clear();
    reader.statistics_.reset();
    reader.Scan();
    return reader;
  } catch (const std::system_error& failure) {
    return reader.Unreadable(failure);
  }
}

Result<std::vector<std::byte>> Reader::ReadBytes(std::uint64_t offset, std::uint64_t count) const {
  if (offset > size() || count > size() - offset) return ErrorAt(size(), "the file ends early");
  std::vector<std::byte> bytes(count);
  source_->Read(offset, bytes);
  return bytes;
}

Result<Reader::Record> Reader::ReadRecord(std::uint64_t offset, std::uint64_t end) const {
  const auto ends_early = [&] {
    if (end < size()) return ErrorAt(offset, "found a record that does not end where it has to");
    return Error{{name()},
                 fmt::format("the file is cut off: its {} bytes end within the record at byte {}", size(), offset),
                 ErrorCode::kFailure};
  };
  if (offset > end || end - offset < kRecordHeader) return ends_early();
  const Result<std::vector<std::byte>> bytes = ReadBytes(offset, kRecordHeader);
  if (!bytes.ok()) return bytes.error();
  ByteReader in(bytes.value());
  Record record;
  record.opcode = in.Read<std::uint8_t>();
  record.offset = offset;
  record.length = in.Read<std::uint64_t>();
  if (!IsKnown(record.opcode)) return ErrorAt(offset, fmt::format("found a record of type {}", record.opcode));
  if (record.length > end - record.content()) return ends_early();
  return record;
}

Status Reader::ReadHeader() {
  std::vector<std::byte> magic(std::min<std::uint64_t>(kMagic.size(), size()));
  source_->Read(0, magic);
  if (magic.empty() || !std::equal(magic.begin(), magic.end(), kMagic.begin())) {
    return Error{{name()},
                 magic.empty() ? "found an empty file, expected an MCAP file"
                               : "found other bytes at the start, expected an MCAP file"};
  }
  const Result<Record> record = ReadRecord(kMagic.size(), size());
  if (!record.ok()) return record.error();
  if (!Is(record.value().opcode, Opcode::kHeader)) return ErrorAt(kMagic.size(), "found no header");
  const Result<std::vector<std::byte>> content = ReadBytes(record.value().content(), record.value().length);
  if (!content.ok()) return content.error();
  ByteReader in(content.value());
  profile_ = in.ReadText();
  library_ = in.ReadText();
  if (!in.ok()) return ErrorAt(kMagic.size(), "found a header that ends early");
  data_start_ = record.value().end();
  return {};
}

Status Reader::ReadSummary() {
  const std::uint64_t end = size();
  if (end < data_start_ + kDataEndRecord + kFooterRecord + kMagic.size()) return ErrorAt(end, "found no footer");
  const std::uint64_t footer_offset = end - kMagic.size() - kFooterRecord;
  const Result<std::vector<std::byte>> footer = ReadBytes(footer_offset, end - footer_offset);
  if (!footer.ok()) return footer.error();
  const std::span<const std::byte> magic = std::span(footer.value()).last(kMagic.size());
  if (!std::equal(magic.begin(), magic.end(), kMagic.begin())) return ErrorAt(footer_offset, "found no magic");
  ByteReader in(footer.value());
  const bool is_footer = Is(in.Read<std::uint8_t>(), Opcode::kFooter) && in.Read<std::uint64_t>() == kFooterLength;
  const auto start = in.Read<std::uint64_t>();
  static_cast<void>(in.Read<std::uint64_t>());  // of the summary offsets
  const auto crc = in.Read<std::uint32_t>();
  if (!is_footer) return ErrorAt(footer_offset, "found no footer");
  if (start < data_start_ + kDataEndRecord || start > footer_offset) return ErrorAt(footer_offset, "found no summary");
  const Result<std::vector<std::byte>> summary = ReadBytes(start, footer_offset - start);
  if (!summary.ok()) return summary.error();
  // The CRC covers the footer's own fields, too, up to the CRC itself.
  const std::span<const std::byte> in_crc = std::span(footer.value()).first(kFooterRecord - sizeof crc);
  if (crc != 0 && Crc32(in_crc, Crc32(summary.value())) != crc) {
    return ErrorAt(start, "the CRC of the summary is not that of its bytes");
  }
  const Result<Record> data_end = ReadRecord(start - kDataEndRecord, start);
  if (!data_end.ok()) return data_end.error();
  if (!Is(data_end.value().opcode, Opcode::kDataEnd) || data_end.value().length != kDataEndLength) {
    return ErrorAt(start, "found no end of the data before the summary");
  }
  const Result<std::vector<std::byte>> data_crc = ReadBytes(data_end.value().content(), kDataEndLength);
  if (!data_crc.ok()) return data_crc.error();
  data_crc_ = ByteReader(data_crc.value()).Read<std::uint32_t>();
  data_end_ = data_end.value().offset;
  return ParseSummary(summary.value(), start);
}

Status Reader::ParseSummary(std::span<const std::byte> bytes, std::uint64_t offset) {
  ByteReader in(bytes);
  while (!in.at_end()) {
    const std::uint64_t at = offset + (bytes.size() - in.remaining());
    const auto opcode = in.Read<std::uint8_t>();
    const std::span<const std::byte> content = in.ReadWithLength<std::uint64_t>();
    if (!in.ok() || !IsKnown(opcode)) return ErrorAt(at, "found a summary that ends early");
    ByteReader record(content);
    if (Is(opcode, Opcode::kSchema) || Is(opcode, Opcode::kChannel)) {
      if (Status failure = ParseChannelOrSchema(opcode, content, at); !failure.ok()) return failure;
    } else if (Is(opcode, Opcode::kStatistics)) {
      statistics_ = ParseStatistics(record);
    } else if (Is(opcode, Opcode::kChunkIndex)) {
      chunks_.push_back(ParseChunkIndex(record));
      const ChunkInfo& chunk = chunks_.back();
      // Ascending, and behind each other: two indices of one chunk would give its messages twice.
      const std::uint64_t begin = chunks_.size() < 2 ? data_start_ : chunks_[chunks_.size() - 2].offset + 1;
      if (chunk.offset < begin || chunk.offset > *data_end_ || chunk.length > *data_end_ - chunk.offset) {
        return ErrorAt(at, "found an index of a chunk outside the data");
      }
    }
    if (!record.ok()) return ErrorAt(at, "found a record that ends early");
  }
  // Messages without an index are not found by it: the file has to be scanned.
  if (chunks_.empty() && (!statistics_ || statistics_->messages > 0)) return ErrorAt(offset, "found no chunk indices");
  return {};
}

Status Reader::ParseChannelOrSchema(std::uint8_t opcode, std::span<const std::byte> content, std::uint64_t offset) {
  ByteReader in(content);
  const auto id = in.Read<std::uint16_t>();
  bool same = true;
  if (Is(opcode, Opcode::kSchema)) {
    Schema schema;
    schema.name = in.ReadText();
    schema.encoding = in.ReadText();
    schema.data = in.ReadText();
    // A definition may be repeated, in the summary and in chunks, but never changed.
    if (in.ok()) same = schemas_.try_emplace(id, schema).first->second == schema;
  } else {
    Channel channel;
    channel.schema = in.Read<std::uint16_t>();
    channel.topic = in.ReadText();
    channel.message_encoding = in.ReadText();
    ByteReader metadata(in.ReadWithLength<std::uint32_t>());
    while (metadata.ok() && !metadata.at_end()) {
      std::string key = metadata.ReadText();
      channel.metadata[std::move(key)] = metadata.ReadText();
    }
    if (!metadata.ok()) return ErrorAt(offset, "found a channel that ends early");
    if (in.ok()) same = channels_.try_emplace(id, channel).first->second == channel;
  }
  if (!in.ok()) return ErrorAt(offset, "found a schema or channel that ends early");
  if (!same) return ErrorAt(offset, fmt::format("found two schemas or channels of one id, {}", id));
  return {};
}

void Reader::Scan() {
  std::uint64_t offset = data_start_;
  for (;;) {
    const Result<Record> record = ReadRecord(offset, size());
    const Result<bool> more = record.ok() ? ScanRecord(record.value()) : record.error();
    if (!more.ok()) {
      // The chunks before the damage stay readable.
      damage_ = {offset, more.error().message};
      return;
    }
    if (!more.value()) {
      data_end_ = offset;
      const Result<std::vector<std::byte>> crc = ReadBytes(record.value().content(), kDataEndLength);
      if (crc.ok()) data_crc_ = ByteReader(crc.value()).Read<std::uint32_t>();
      damage_ = {record.value().end(), fmt::format("byte {}: the summary is missing or damaged", record.value().end())};
      return;
    }
    offset = record.value().end();
  }
}

Result<bool> Reader::ScanRecord(const Record& record) {
  if (Is(record.opcode, Opcode::kDataEnd)) {
    if (record.length < kDataEndLength) return ErrorAt(record.offset, "found an end of the data that ends early");
    return false;
  }
  if (Is(record.opcode, Opcode::kHeader) || Is(record.opcode, Opcode::kFooter) ||
      Is(record.opcode, Opcode::kChunkIndex) || Is(record.opcode, Opcode::kSummaryOffset) ||
      Is(record.opcode, Opcode::kStatistics)) {
    return ErrorAt(record.offset, fmt::format("found a record of type {} in the data", record.opcode));
  }
  if (Is(record.opcode, Opcode::kSchema) || Is(record.opcode, Opcode::kChannel)) {
    const Result<std::vector<std::byte>> content = ReadBytes(record.content(), record.length);
    if (!content.ok()) return content.error();
    if (Status failure = ParseChannelOrSchema(record.opcode, content.value(), record.offset); !failure.ok()) {
      return failure.error();
    }
  }
  if (!Is(record.opcode, Opcode::kChunk)) return true;
  std::uint32_t crc = 0;
  std::uint64_t records = 0;
  Result<ChunkInfo> info = ReadChunkInfo(record, crc, records);
  if (!info.ok()) return info.error();
  // A scan decompresses each chunk: the schemas and channels that it uses may be in it, and a chunk counts only if it
  // is whole.
  const Result<Chunk> chunk = ReadChunk(info.value(), this);
  if (!chunk.ok()) return chunk.error();
  std::vector<std::uint16_t>& ids = info.value().channels;
  for (const Message& message : chunk.value().messages) {
    const auto at = std::lower_bound(ids.begin(), ids.end(), message.channel);
    if (at == ids.end() || *at != message.channel) ids.insert(at, message.channel);
  }
  chunks_.push_back(std::move(info).value());
  return true;
}

Result<ChunkInfo> Reader::ReadChunkInfo(const Record& record, std::uint32_t& crc, std::uint64_t& records) const {
  // Only the fields: a scan would otherwise read every chunk twice.
  const std::uint64_t longest = std::min(record.length, kChunkFields + kMaxCompression);
  const Result<std::vector<std::byte>> fields = ReadBytes(record.content(), longest);
  if (!fields.ok()) return fields.error();
  ByteReader in(fields.value());
  ChunkInfo info;
  info.offset = record.offset;
  info.length = record.end() - record.offset;
  info.start_time = in.Read<std::uint64_t>();
  info.end_time = in.Read<std::uint64_t>();
  info.uncompressed_size = in.Read<std::uint64_t>();
  crc = in.Read<std::uint32_t>();
  info.compression = in.ReadText();
  info.compressed_size = in.Read<std::uint64_t>();
  records = record.content() + (longest - in.remaining());
  if (!in.ok() || info.compressed_size != record.end() - records) {
    return ErrorAt(record.offset, "found a chunk whose sizes do not match");
  }
  return info;
}

Result<Chunk> Reader::ReadChunk(std::size_t index) const try {
  return ReadChunk(chunks_[index], nullptr);
} catch (const std::system_error& failure) {
  return Unreadable(failure);
}

// `definitions`: the reader that learns the schemas and channels in the chunk; null: they are in the summary.
Result<Chunk> Reader::ReadChunk(const ChunkInfo& info, Reader* definitions) const {
  const Result<Record> record = ReadRecord(info.offset, info.offset + info.length);
  if (!record.ok()) return record.error();
  if (!Is(record.value().opcode, Opcode::kChunk)) return ErrorAt(info.offset, "found no chunk");
  std::uint32_t crc = 0;
  std::uint64_t records = 0;
  Result<ChunkInfo> found = ReadChunkInfo(record.value(), crc, records);
  if (!found.ok()) return found.error();
  found.value().channels = info.channels;
  // The index and the chunk are both of unknown origin: sizes that are used below have to agree.
  if (found.value() != info) return ErrorAt(info.offset, "found a chunk that differs from its index");
  if (info.uncompressed_size > kMaxChunk) return ErrorAt(info.offset, "found a chunk of more than 1 GiB");

  Result<std::vector<std::byte>> bytes = ReadBytes(records, info.compressed_size);
  if (!bytes.ok()) return bytes.error();
  if (info.compression == kZstd) {
    bytes = Decompress(bytes.value(), info.uncompressed_size);
    if (!bytes.ok()) return ErrorAt(info.offset, "the chunk is damaged: " + bytes.error().message);
  } else if (info.compression != kUncompressed) {
    return ErrorAt(info.offset,
                   fmt::format("found a chunk compressed with {:?}, expected zstd", CutUtf8(info.compression, 16)));
  } else if (bytes.value().size() != info.uncompressed_size) {
    return ErrorAt(info.offset, "found a chunk whose sizes do not match");
  }
  // By the specification a CRC of 0 means that there is none.
  if (const std::uint32_t own = Crc32(bytes.value()); crc != 0 && own != crc) {
    return ErrorAt(info.offset, fmt::format("the chunk is damaged: found the CRC {:08x}, expected {:08x}", own, crc));
  }

  Chunk chunk;
  chunk.records = std::move(bytes).value();
  ByteReader in(chunk.records);
  while (!in.at_end()) {
    const auto opcode = in.Read<std::uint8_t>();
    const std::span<const std::byte> content = in.ReadWithLength<std::uint64_t>();
    if (!in.ok()) return ErrorAt(info.offset, "found a record in the chunk that ends early");
    if (definitions != nullptr && (Is(opcode, Opcode::kSchema) || Is(opcode, Opcode::kChannel))) {
      if (Status failure = definitions->ParseChannelOrSchema(opcode, content, info.offset); !failure.ok()) {
        return failure.error();
      }
    }
    if (!Is(opcode, Opcode::kMessage)) continue;
    ByteReader fields(content);
    Message message;
    message.channel = fields.Read<std::uint16_t>();
    message.sequence = fields.Read<std::uint32_t>();
    message.log_time = fields.Read<std::uint64_t>();
    message.publish_time = fields.Read<std::uint64_t>();
    message.data = fields.ReadBytes(fields.remaining());
    if (!fields.ok()) return ErrorAt(info.offset, "found a message that ends early");
    if (!channels_.contains(message.channel)) {
      return ErrorAt(info.offset, fmt::format("found a message of channel {}, which is not declared", message.channel));
    }
    chunk.messages.push_back(message);
  }
  return chunk;
}

std::uint32_t Reader::CrcUntil(std::uint64_t end) const {
  std::vector<std::byte> bytes;
  std::uint32_t crc = 0;
  for (std::uint64_t offset = 0; offset < end; offset += bytes.size()) {
    bytes.resize(std::min(kReadSize, end - offset));
    source_->Read(offset, bytes);
    crc = Crc32(bytes, crc);
  }
  return crc;
}

Status Reader::CheckData() const try {
  if (!data_end_ || data_crc_ == 0) return {};
  const std::uint32_t crc = CrcUntil(*data_end_);
  if (crc == data_crc_) return {};
  return ErrorAt(*data_end_, fmt::format("found the CRC {:08x} of the data, expected {:08x}", crc, data_crc_));
} catch (const std::system_error& failure) {
  return Unreadable(failure);
}

std::optional<IndexedChunk> Reader::ReadIndices(const ChunkInfo& info, Statistics& statistics) const {
  IndexedChunk chunk{info, {}, 0};
  Statistics with_chunk = statistics;
  const std::uint64_t begin = info.offset + info.length;
  std::uint64_t offset = begin;
  while (chunk.index_offsets.size() < info.channels.size()) {
    const Result<Record> record = ReadRecord(offset, size());
    if (!record.ok() || !Is(record.value().opcode, Opcode::kMessageIndex)) return std::nullopt;
    const Result<std::vector<std::byte>> content = ReadBytes(record.value().content(), record.value().length);
    if (!content.ok()) return std::nullopt;
    ByteReader in(content.value());
    const auto channel = in.Read<std::uint16_t>();
    const std::uint64_t messages = in.ReadWithLength<std::uint32_t>().size() / (2 * sizeof(std::uint64_t));
    // One index for each channel, without a gap: anything else was not written by this program's writer, and is written
    // again.
    const bool is_next = in.ok() && in.at_end() && chunk.index_offsets.emplace(channel, offset).second;
    if (!is_next) return std::nullopt;
    with_chunk.messages += messages;
    with_chunk.channel_messages[channel] += messages;
    offset = record.value().end();
  }
  chunk.index_length = offset - begin;
  with_chunk.start_time = std::min(with_chunk.start_time, info.start_time);
  with_chunk.end_time = std::max(with_chunk.end_time, info.end_time);
  statistics = std::move(with_chunk);
  return chunk;
}

Result<WrittenPart> Reader::ReadWrittenPart() const try {
  WrittenPart part;
  part.size = data_start_;
  part.schemas = schemas_;
  part.channels = channels_;
  if (!chunks_.empty()) part.statistics.start_time = chunks_.front().start_time;
  for (const ChunkInfo& info : chunks_) {
    std::optional<IndexedChunk> chunk = ReadIndices(info, part.statistics);
    // A chunk without its indices was the last one when the writer was killed: the continued file ends before it.
    if (!chunk) break;
    part.size = info.offset + info.length + chunk->index_length;
    part.chunks.push_back(std::move(*chunk));
  }
  part.crc = CrcUntil(part.size);
  return part;
} catch (const std::system_error& failure) {
  return Unreadable(failure);
}

}  // namespace troupe::mcap
