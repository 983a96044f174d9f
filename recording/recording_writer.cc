#include "recording/recording_writer.h"

#include <map>
#include <string>

#include "common/base/identity.h"

namespace troupe {
namespace {

// Larger ones compress no better.
constexpr std::size_t kChunkSize = std::size_t{1} << 20;  // bytes

}  // namespace

Result<RecordingWriter> RecordingWriter::Create(std::unique_ptr<mcap::ByteSink> sink, const RecordedRun& run,
                                                Chunks chunks) {
  Result<mcap::Writer> file =
      mcap::Writer::Create(std::move(sink), kRecordingProfile, std::string("troupe ") + VersionText());
  if (!file.ok()) return file.error();
  if (chunks == Chunks::kPlain) file.value().LeaveUncompressed();
  RecordingWriter writer(std::move(file).value(), run.run, run.world.interval_ns);
  for (std::size_t i = 0; i < kRecordingChannels; ++i) {
    const std::uint16_t schema = writer.writer_.AddSchema(SchemaOf(kChannelTypes[i]));
    writer.ids_[i] = writer.writer_.AddChannel({schema, kChannelTypes[i].topic, "cdr"});
  }
  writer.Add(RecordingChannel::kRun, RunToBytes(run), RecordedTick());
  if (Status failure = writer.EndChunk(); !failure.ok()) return failure.error();
  return writer;
}

RecordingWriter RecordingWriter::Continue(std::unique_ptr<mcap::ByteSink> sink, mcap::WrittenPart written, RunId run,
                                          std::int64_t interval_ns, std::uint64_t log_time) {
  const std::map<std::uint16_t, mcap::Channel> channels = written.channels;
  RecordingWriter writer(mcap::Writer::Continue(std::move(sink), std::move(written)), run, interval_ns);
  for (const auto& [id, channel] : channels) {
    for (std::size_t i = 0; i < kRecordingChannels; ++i) {
      if (channel.topic == kChannelTypes[i].topic) writer.ids_[i] = id;
    }
  }
  writer.log_time_ = log_time;
  return writer;
}

Status RecordingWriter::EndChunk() {
  Status ended = writer_.EndChunk();
  if (ended.ok()) first_unwritten_ = next_number_;
  return ended;
}

void RecordingWriter::Add(RecordingChannel channel, std::span<const std::byte> data, const RecordedTick& tick) {
  writer_.Add({.channel = ids_[static_cast<std::size_t>(channel)],
               .sequence = static_cast<std::uint32_t>(tick.number),
               .log_time = log_time_,
               .publish_time = tick.tick * interval_ns_,
               .data = data});
}

Status RecordingWriter::Add(const RecordedTick& tick) {
  // A reader that starts at a keyframe reads one chunk from its begin.
  if (tick.keyframe) {
    if (Status failure = EndChunk(); !failure.ok()) return failure;
  }
  next_number_ = tick.number + 1;
  if (tick.is_step()) log_time_ += interval_ns_;
  if (tick.edit && ReplacesWorld(tick.edit->request) && tick.edit->world) {
    interval_ns_ = static_cast<std::uint64_t>(tick.edit->world->interval_ns);
  }
  for (const TickMessage& message : MessagesOf(tick, run_)) Add(message.channel, message.data, tick);
  return writer_.open_size() < kChunkSize ? Status() : EndChunk();
}

Result<std::vector<std::byte>> PlainCopy(const Recording& recording) {
  std::vector<std::byte> bytes;
  Result<RecordingWriter> writer =
      RecordingWriter::Create(mcap::MakeMemorySink(bytes), recording.run(), RecordingWriter::Chunks::kPlain);
  if (!writer.ok()) return writer.error();
  TickReader reader(recording);
  RecordedTick tick;
  for (bool is_first = true;; is_first = false) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok() && is_first) return more.error();
    if (!more.ok() || !more.value()) break;
    if (Status failure = writer.value().Add(tick); !failure.ok()) return failure.error();
  }
  if (Status failure = writer.value().Close(); !failure.ok()) return failure.error();
  return bytes;
}

}  // namespace troupe
