// RecordingWriter: writes a recorded run, tick by tick. Ticks are in chunks, each of which is readable once it is
// written; a keyframe begins a chunk.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "common/base/result.h"
#include "common/recording/channels.h"
#include "common/recording/mcap/byte_sink.h"
#include "common/recording/mcap/writer.h"
#include "common/recording/recorded_run.h"

namespace troupe {

class RecordingWriter {
 public:
  // Writes the begin of the run.
  static Result<RecordingWriter> Create(std::unique_ptr<mcap::ByteSink> sink, const RecordedRun& run);

  // Adds the next committed state; its log time is computed here. Errors are those of the sink.
  Status Add(const RecordedTick& tick);
  // Makes the ticks so far readable, should the process end.
  Status EndChunk() { return writer_.EndChunk(); }
  Status Close() { return writer_.Close(); }

 private:
  RecordingWriter(mcap::Writer writer, const WorldDescription& world);
  void Add(RecordingChannel channel, std::span<const std::byte> data, const RecordedTick& tick);

  mcap::Writer writer_;
  std::array<std::uint16_t, kRecordingChannels> ids_ = {};
  RunId run_ = 0;
  std::uint64_t interval_ns_;
  std::uint64_t log_time_ = 0;  // of the newest tick
};

}  // namespace troupe
