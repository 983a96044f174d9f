#include "common/recording/recording_writer.h"

#include <string>
#include <utility>

#include "common/base/version.h"
#include "common/recording/convert_recorded.h"
#include "common/wire/message_bytes.h"

namespace troupe {
namespace {

// Larger ones compress no better.
constexpr std::size_t kChunkSize = std::size_t{1} << 20;  // bytes

std::uint64_t IntervalOf(const WorldDescription& world) {
  return static_cast<std::uint64_t>(world.interval_ns);
}

}  // namespace

RecordingWriter::RecordingWriter(mcap::Writer writer, const WorldDescription& world)
    : writer_(std::move(writer)), interval_ns_(IntervalOf(world)) {
  for (std::size_t i = 0; i < kRecordingChannels; ++i) {
    const std::uint16_t schema = writer_.AddSchema(SchemaOf(kChannelTypes[i]));
    ids_[i] = writer_.AddChannel({schema, kChannelTypes[i].topic, "cdr"});
  }
}

Result<RecordingWriter> RecordingWriter::Create(std::unique_ptr<mcap::ByteSink> sink, const RecordedRun& run) {
  Result<mcap::Writer> file =
      mcap::Writer::Create(std::move(sink), kRecordingProfile, std::string("troupe ") + VersionText());
  if (!file.ok()) return file.error();
  RecordingWriter writer(std::move(file).value(), run.world);
  writer.run_ = run.run;
  writer.Add(RecordingChannel::kRun, RunToBytes(run), RecordedTick());
  if (Status failure = writer.EndChunk(); !failure.ok()) return failure.error();
  return writer;
}

void RecordingWriter::Add(RecordingChannel channel, std::span<const std::byte> data, const RecordedTick& tick) {
  writer_.Add({.channel = ids_[static_cast<std::size_t>(channel)],
               .sequence = static_cast<std::uint32_t>(tick.number),
               .log_time = log_time_,
               .publish_time = tick.tick * interval_ns_,
               .data = data});
}

Status RecordingWriter::Add(const RecordedTick& tick) {
  if (tick.keyframe) {
    if (Status failure = writer_.EndChunk(); !failure.ok()) return failure;
  }
  if (tick.is_step()) {
    log_time_ += interval_ns_;
    ProposalMessage message;
    message.run = run_;
    message.tick = tick.tick;
    message.edition = tick.edition;
    message.proposals = tick.proposals;
    Add(RecordingChannel::kProposals, wire::ToBytes(message), tick);
  }
  if (tick.edit) {
    if (tick.edit->request.command == ControlCommand::kLoadWorld && tick.edit->world) {
      interval_ns_ = IntervalOf(*tick.edit->world);
    }
    Add(RecordingChannel::kEdits, EditToBytes(*tick.edit), tick);
  }
  if (tick.keyframe) Add(RecordingChannel::kKeyframes, wire::ToBytes(*tick.keyframe), tick);
  Add(RecordingChannel::kTicks, TickToBytes(tick), tick);
  return writer_.open_size() < kChunkSize ? Status() : writer_.EndChunk();
}

}  // namespace troupe
