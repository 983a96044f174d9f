// Writing an MCAP file front to back: nothing that has been written is changed later, so that a sink may be a pipe and
// a killed writer leaves whole chunks. Positions, counts and the CRC of all bytes are kept in `written_`, from which
// the summary is made at the end, or by another process that continues the file (Continue).
#include "recording/mcap/writer.h"

#include <algorithm>
#include <utility>

#include "troupe/check.h"

namespace troupe::mcap {
namespace {

void AddSchemaRecord(ByteWriter<>& writer, std::uint16_t id, const Schema& schema) {
  WriteRecord(writer, Opcode::kSchema, [&] {
    writer.Write(id);
    writer.WriteText(schema.name);
    writer.WriteText(schema.encoding);
    writer.WriteText(schema.data);
  });
}

void AddChannelRecord(ByteWriter<>& writer, std::uint16_t id, const Channel& channel) {
  WriteRecord(writer, Opcode::kChannel, [&] {
    writer.Write(id);
    writer.Write(channel.schema);
    writer.WriteText(channel.topic);
    writer.WriteText(channel.message_encoding);
    writer.WriteWithLength<std::uint32_t>([&] {
      for (const auto& [key, value] : channel.metadata) {
        writer.WriteText(key);
        writer.WriteText(value);
      }
    });
  });
}

void AddMap(ByteWriter<>& writer, const std::map<std::uint16_t, std::uint64_t>& map) {
  writer.WriteWithLength<std::uint32_t>([&] {
    for (const auto& [key, value] : map) {
      writer.Write(key);
      writer.Write(value);
    }
  });
}

}  // namespace

Result<Writer> Writer::Create(std::unique_ptr<ByteSink> sink, const std::string& profile, const std::string& library) {
  Writer writer(std::move(sink));
  ByteWriter out(writer.buffer_);
  out.WriteBytes(kMagic);
  WriteRecord(out, Opcode::kHeader, [&] {
    out.WriteText(profile);
    out.WriteText(library);
  });
  writer.WriteBuffer();
  if (!writer.status_.ok()) return writer.status_.error();
  return writer;
}

Writer Writer::Continue(std::unique_ptr<ByteSink> sink, WrittenPart part) {
  Writer writer(std::move(sink));
  writer.written_ = std::move(part);
  return writer;
}

std::uint16_t Writer::AddSchema(const Schema& schema) {
  const auto id = static_cast<std::uint16_t>(written_.schemas.size() + 1);  // 0 means none
  written_.schemas.emplace(id, schema);
  ByteWriter out(buffer_);
  AddSchemaRecord(out, id, schema);
  WriteBuffer();
  return id;
}

std::uint16_t Writer::AddChannel(const Channel& channel) {
  const auto id = static_cast<std::uint16_t>(written_.channels.size());
  written_.channels.emplace(id, channel);
  ByteWriter out(buffer_);
  AddChannelRecord(out, id, channel);
  WriteBuffer();
  return id;
}

void Writer::Add(const Message& message) {
  TROUPE_CHECK(written_.channels.contains(message.channel));
  // Times may go back within a chunk: the range is that of its messages, not of the first and the last.
  if (records_.empty()) start_time_ = end_time_ = message.log_time;
  start_time_ = std::min(start_time_, message.log_time);
  end_time_ = std::max(end_time_, message.log_time);
  indices_[message.channel].push_back({message.log_time, records_.size()});
  ByteWriter out(records_);
  WriteRecord(out, Opcode::kMessage, [&] {
    out.Write(message.channel);
    out.Write(message.sequence);
    out.Write(message.log_time);
    out.Write(message.publish_time);
    out.WriteBytes(message.data);
  });
}

Status Writer::EndChunk() {
  if (records_.empty() || !status_.ok()) return status_;
  compressor_.Compress(records_, compressed_);
  const char* const compression = compressor_.compresses() ? kZstd : kUncompressed;
  IndexedChunk chunk;
  ChunkInfo& info = chunk.info;
  // The length is known when the record is written.
  info = {written_.size, 0, start_time_, end_time_, compression, compressed_.size(), records_.size(), {}};
  ByteWriter out(buffer_);
  WriteRecord(out, Opcode::kChunk, [&] {
    out.Write(start_time_);
    out.Write(end_time_);
    out.Write(std::uint64_t{records_.size()});
    out.Write(Crc32(records_));
    out.WriteText(compression);
    out.WriteWithLength<std::uint64_t>([&] { out.WriteBytes(compressed_); });
  });
  info.length = out.size();
  for (const auto& [channel, entries] : indices_) {
    chunk.index_offsets[channel] = written_.size + out.size();
    written_.statistics.channel_messages[channel] += entries.size();
    written_.statistics.messages += entries.size();
    WriteRecord(out, Opcode::kMessageIndex, [&, id = channel] {
      out.Write(id);
      out.WriteWithLength<std::uint32_t>([&] {
        for (const IndexEntry& entry : indices_.at(id)) {
          out.Write(entry.log_time);
          out.Write(entry.offset);
        }
      });
    });
  }
  chunk.index_length = out.size() - info.length;
  written_.statistics.start_time =
      written_.chunks.empty() ? start_time_ : std::min(written_.statistics.start_time, start_time_);
  written_.statistics.end_time = std::max(written_.statistics.end_time, end_time_);
  written_.chunks.push_back(std::move(chunk));
  // The buffers keep their memory for the next chunk.
  records_.clear();
  indices_.clear();
  WriteBuffer();
  return status_;
}

void Writer::Write(std::span<const std::byte> bytes) {
  written_.crc = Crc32(bytes, written_.crc);
  written_.size += bytes.size();
  if (status_.ok()) status_ = sink_->Write(bytes);
}

void Writer::WriteBuffer() {
  Write(buffer_);
  buffer_.clear();
}

void Writer::WriteSummary() {
  ByteWriter out(buffer_);
  WriteRecord(out, Opcode::kDataEnd, [&] { out.Write(written_.crc); });
  WriteBuffer();

  const std::uint64_t summary_start = written_.size;
  std::vector<std::pair<Opcode, std::pair<std::uint64_t, std::uint64_t>>> groups;  // with their offsets and lengths
  const auto add_group = [&](Opcode opcode, const auto& add_records) {
    const std::size_t begin = out.size();
    add_records();
    if (out.size() > begin) groups.push_back({opcode, {summary_start + begin, out.size() - begin}});
  };
  add_group(Opcode::kSchema, [&] {
    for (const auto& [id, schema] : written_.schemas) AddSchemaRecord(out, id, schema);
  });
  add_group(Opcode::kChannel, [&] {
    for (const auto& [id, channel] : written_.channels) AddChannelRecord(out, id, channel);
  });
  add_group(Opcode::kStatistics, [&] {
    WriteRecord(out, Opcode::kStatistics, [&] {
      out.Write(written_.statistics.messages);
      out.Write(static_cast<std::uint16_t>(written_.schemas.size()));
      out.Write(static_cast<std::uint32_t>(written_.channels.size()));
      out.Write(std::uint32_t{0});  // attachments
      out.Write(std::uint32_t{0});  // metadata
      out.Write(static_cast<std::uint32_t>(written_.chunks.size()));
      out.Write(written_.statistics.start_time);
      out.Write(written_.statistics.end_time);
      AddMap(out, written_.statistics.channel_messages);
    });
  });
  add_group(Opcode::kChunkIndex, [&] {
    for (const IndexedChunk& chunk : written_.chunks) {
      WriteRecord(out, Opcode::kChunkIndex, [&] {
        out.Write(chunk.info.start_time);
        out.Write(chunk.info.end_time);
        out.Write(chunk.info.offset);
        out.Write(chunk.info.length);
        AddMap(out, chunk.index_offsets);
        out.Write(chunk.index_length);
        out.WriteText(chunk.info.compression);
        out.Write(chunk.info.compressed_size);
        out.Write(chunk.info.uncompressed_size);
      });
    }
  });
  const std::uint64_t summary_offset_start = summary_start + out.size();
  for (const auto& [opcode, place] : groups) {
    WriteRecord(out, Opcode::kSummaryOffset, [&, group = opcode, start = place.first, length = place.second] {
      out.Write(static_cast<std::uint8_t>(group));
      out.Write(start);
      out.Write(length);
    });
  }
  WriteRecord(out, Opcode::kFooter, [&] {
    out.Write(summary_start);
    out.Write(summary_offset_start);
    // The record's header and length are in the buffer already, the length as 0.
    std::uint64_t length = kFooterLength;
    std::memcpy(buffer_.data() + out.size() - 3 * sizeof length, &length, sizeof length);
    out.Write(Crc32(buffer_));
  });
  out.WriteBytes(kMagic);
  WriteBuffer();
}

Status Writer::Close() {
  if (Status failure = EndChunk(); !failure.ok()) {
    static_cast<void>(sink_->Close());
    return failure;
  }
  WriteSummary();
  const Status closed = sink_->Close();
  return status_.ok() ? closed : status_;
}

}  // namespace troupe::mcap
