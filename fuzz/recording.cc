// Feeds any bytes to the reader of recordings, and replays what it accepts: from the start, and from the last keyframe.
#include "recording/recording.h"

#include <algorithm>
#include <vector>

#include "fuzz/targets.h"
#include "recording/mcap/bytes.h"
#include "recording/mcap/writer.h"
#include "recording/recorded_run.h"
#include "world-service/replay/run_replay.h"

namespace troupe::fuzz {
namespace {

// Bytes at random are thousands of empty messages and chunks: they cost time, and test nothing that a few do not.
constexpr int kMaxParts = 64;

// A file of the messages in the bytes: each behind its channel, one byte, and its length, two. Another number in place
// of a channel ends a chunk. So the CRCs of a file do not keep changed messages from the readers.
std::vector<std::byte> FileOf(Bytes bytes) {
  std::vector<std::byte> file;
  mcap::Writer writer = mcap::Writer::Create(mcap::MakeMemorySink(file), kRecordingProfile, "fuzz").value();
  for (const ChannelType& channel : kChannelTypes) {
    writer.AddChannel({writer.AddSchema(SchemaOf(channel)), channel.topic, "cdr"});
  }
  ByteReader in(bytes);
  std::uint64_t time = 0;
  for (int part = 0; part < kMaxParts && in.ok() && !in.at_end(); ++part) {
    const auto channel = in.Read<std::uint8_t>();
    if (channel >= kRecordingChannels) {
      Check(writer.EndChunk().ok());
      continue;
    }
    writer.Add({.channel = channel, .log_time = time, .data = in.ReadWithLength<std::uint16_t>()});
    if (channel == static_cast<std::uint8_t>(RecordingChannel::kTicks)) time += 100'000'000;
  }
  Check(writer.Close().ok());
  return file;
}

void Replay(const troupe::Recording& recording, std::optional<Tick> from) {
  ReplayOptions options;
  options.from = from;
  options.compare_events = true;
  const Result<ReplayReport> report = RunReplay(recording, options).Run();
  Check(report.ok());
  Check(report.value().damage || report.value().difference || report.value().states > 0);
}

}  // namespace

void Recording(Bytes bytes) {
  if (bytes.empty()) return;
  const bool is_file = bytes.front() == std::byte{0};
  const std::vector<std::byte> made = is_file ? std::vector<std::byte>() : FileOf(bytes.subspan(1));
  const Bytes file = is_file ? bytes.subspan(1) : Bytes(made);
  const Result<troupe::Recording> recording = troupe::Recording::Open(mcap::MakeMemorySource("fuzz.mcap", file));
  if (!recording.ok()) {
    Check(!recording.error().message.empty());
    return;
  }
  // Its verdict is not judged: a replay must be safe whether or not it was asked before.
  static_cast<void>(recording.value().CheckData());
  Replay(recording.value(), std::nullopt);
  const TimeSpans& spans = recording.value().spans();
  if (spans.First(spans.greatest())) Replay(recording.value(), spans.greatest());
}

}  // namespace troupe::fuzz
