#include "launcher/export/mcap_file.h"

#include <memory>
#include <utility>

#include "common/base/identity.h"
#include "recording/mcap/byte_stream.h"

namespace troupe {
namespace {

constexpr std::size_t kChunkSize = std::size_t{1} << 20;  // bytes: larger ones compress no better

}  // namespace

Result<McapFile> McapFile::Create(const std::string& path, const std::string& profile) {
  Result<std::unique_ptr<mcap::ByteSink>> sink = mcap::CreateFileSink(path);
  if (!sink.ok()) return sink.error();
  Result<mcap::Writer> writer =
      mcap::Writer::Create(std::move(sink).value(), profile, std::string("troupe ") + VersionText());
  if (!writer.ok()) return writer.error();
  return McapFile(std::move(writer).value());
}

// Topics of one type share a schema; a channel is one topic.
std::uint16_t McapFile::AddTopic(const Topic& topic) {
  auto schema = schemas_.find(topic.schema.name);
  if (schema == schemas_.end()) {
    schema = schemas_.emplace(topic.schema.name, writer_.AddSchema(topic.schema)).first;
  }
  const std::uint16_t channel =
      writer_.AddChannel({schema->second, topic.name, topic.message_encoding, topic.metadata});
  channels_.emplace(topic.name, channel);
  counts_[channel] = {topic.name, topic.schema.name, topic.metadata, 0};
  return channel;
}

// A chunk ends by size, not by time: it is the unit of compression and of an index entry.
Status McapFile::Write(std::uint16_t topic, std::uint64_t time, std::span<const std::byte> message) {
  TopicCount& count = counts_.at(topic);
  writer_.Add({.channel = topic,
               .sequence = static_cast<std::uint32_t>(count.messages),
               .log_time = time,
               .publish_time = time,
               .data = message});
  ++count.messages;
  if (messages_++ == 0) first_time_ = time;
  last_time_ = time;
  return writer_.open_size() < kChunkSize ? Status() : writer_.EndChunk();
}

}  // namespace troupe
