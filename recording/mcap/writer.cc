#include "recording/mcap/writer.h"

#include <algorithm>
#include <utility>

#include "troupe/check.h"

namespace troupe::mcap {
namespace {

void AddSchemaRecord(ByteWriter& writer, std::uint16_t id, const Schema& schema) {
  writer.AddRecord(Opcode::kSchema, [&] {
    writer.Add(id);
    writer.Add(std::string_view(schema.name));
    writer.Add(std::string_view(schema.encoding));
    writer.Add(std::string_view(schema.data));
  });
}

void AddChannelRecord(ByteWriter& writer, std::uint16_t id, const Channel& channel) {
  writer.AddRecord(Opcode::kChannel, [&] {
    writer.Add(id);
    writer.Add(channel.schema);
    writer.Add(std::string_view(channel.topic));
    writer.Add(std::string_view(channel.message_encoding));
    writer.AddWithLength<std::uint32_t>([&] {
      for (const auto& [key, value] : channel.metadata) {
        writer.Add(std::string_view(key));
        writer.Add(std::string_view(value));
      }
    });
  });
}

void AddMap(ByteWriter& writer, const std::map<std::uint16_t, std::uint64_t>& map) {
  writer.AddWithLength<std::uint32_t>([&] {
    for (const auto& [key, value] : map) {
      writer.Add(key);
      writer.Add(value);
    }
  });
}

}  // namespace

Result<Writer> Writer::Create(std::unique_ptr<ByteSink> sink, const std::string& profile, const std::string& library) {
  Writer writer(std::move(sink));
  ByteWriter out(writer.buffer_);
  out.Add(std::span<const std::byte>(kMagic));
  out.AddRecord(Opcode::kHeader, [&] {
    out.Add(std::string_view(profile));
    out.Add(std::string_view(library));
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
  if (records_.empty()) start_time_ = end_time_ = message.log_time;
  start_time_ = std::min(start_time_, message.log_time);
  end_time_ = std::max(end_time_, message.log_time);
  indices_[message.channel].push_back({message.log_time, records_.size()});
  ByteWriter out(records_);
  out.AddRecord(Opcode::kMessage, [&] {
    out.Add(message.channel);
    out.Add(message.sequence);
    out.Add(message.log_time);
    out.Add(message.publish_time);
    out.Add(message.data);
  });
}

Status Writer::EndChunk() {
  if (records_.empty() || !status_.ok()) return status_;
  compressor_.Compress(records_, compressed_);
  const char* const compression = compressor_.compresses() ? kZstd : kUncompressed;
  IndexedChunk chunk;
  ChunkInfo& info = chunk.info;
  info = {written_.size, 0, start_time_, end_time_, compression, compressed_.size(), records_.size(), {}};
  ByteWriter out(buffer_);
  out.AddRecord(Opcode::kChunk, [&] {
    out.Add(start_time_);
    out.Add(end_time_);
    out.Add(std::uint64_t{records_.size()});
    out.Add(Crc32(records_));
    out.Add(std::string_view(compression));
    out.AddWithLength<std::uint64_t>([&] { out.Add(std::span<const std::byte>(compressed_)); });
  });
  info.length = out.size();
  for (const auto& [channel, entries] : indices_) {
    chunk.index_offsets[channel] = written_.size + out.size();
    written_.statistics.channel_messages[channel] += entries.size();
    written_.statistics.messages += entries.size();
    out.AddRecord(Opcode::kMessageIndex, [&, id = channel] {
      out.Add(id);
      out.AddWithLength<std::uint32_t>([&] {
        for (const IndexEntry& entry : indices_.at(id)) {
          out.Add(entry.log_time);
          out.Add(entry.offset);
        }
      });
    });
  }
  chunk.index_length = out.size() - info.length;
  written_.statistics.start_time =
      written_.chunks.empty() ? start_time_ : std::min(written_.statistics.start_time, start_time_);
  written_.statistics.end_time = std::max(written_.statistics.end_time, end_time_);
  written_.chunks.push_back(std::move(chunk));
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
  out.AddRecord(Opcode::kDataEnd, [&] { out.Add(written_.crc); });
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
    out.AddRecord(Opcode::kStatistics, [&] {
      out.Add(written_.statistics.messages);
      out.Add(static_cast<std::uint16_t>(written_.schemas.size()));
      out.Add(static_cast<std::uint32_t>(written_.channels.size()));
      out.Add(std::uint32_t{0});  // attachments
      out.Add(std::uint32_t{0});  // metadata
      out.Add(static_cast<std::uint32_t>(written_.chunks.size()));
      out.Add(written_.statistics.start_time);
      out.Add(written_.statistics.end_time);
      AddMap(out, written_.statistics.channel_messages);
    });
  });
  add_group(Opcode::kChunkIndex, [&] {
    for (const IndexedChunk& chunk : written_.chunks) {
      out.AddRecord(Opcode::kChunkIndex, [&] {
        out.Add(chunk.info.start_time);
        out.Add(chunk.info.end_time);
        out.Add(chunk.info.offset);
        out.Add(chunk.info.length);
        AddMap(out, chunk.index_offsets);
        out.Add(chunk.index_length);
        out.Add(std::string_view(chunk.info.compression));
        out.Add(chunk.info.compressed_size);
        out.Add(chunk.info.uncompressed_size);
      });
    }
  });
  const std::uint64_t summary_offset_start = summary_start + out.size();
  for (const auto& [opcode, place] : groups) {
    out.AddRecord(Opcode::kSummaryOffset, [&, group = opcode, start = place.first, length = place.second] {
      out.Add(static_cast<std::uint8_t>(group));
      out.Add(start);
      out.Add(length);
    });
  }
  out.AddRecord(Opcode::kFooter, [&] {
    out.Add(summary_start);
    out.Add(summary_offset_start);
    // The record's header and length are in the buffer already, the length as 0.
    std::uint64_t length = kFooterLength;
    std::memcpy(buffer_.data() + out.size() - 3 * sizeof length, &length, sizeof length);
    out.Add(Crc32(buffer_));
  });
  out.Add(std::span<const std::byte>(kMagic));
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
