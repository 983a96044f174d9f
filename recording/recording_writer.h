// RecordingWriter: writes a recorded run, tick by tick. Ticks are in chunks, each of which is readable once it is
// written; a keyframe begins a chunk.
//
// The log time of a tick is simulated time since the first state, and never decreases, unlike ticks, so that other
// tools can show a recording with edits and rewinds. Errors of the sink stay; Add after one does nothing.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "recording/mcap/byte_stream.h"
#include "recording/mcap/writer.h"
#include "recording/recorded_run.h"
#include "recording/recording.h"
#include "troupe/result.h"

namespace troupe {

class RecordingWriter {
 public:
  enum class Chunks : bool { kCompressed, kPlain };
  // Writes the start of the run.
  static Result<RecordingWriter> Create(std::unique_ptr<mcap::ByteSink> sink, const RecordedRun& run,
                                        Chunks chunks = Chunks::kCompressed);

  // Continues a recording of the run, whose last tick has this log time and ticks last `interval_ns`: the sink appends
  // to its written part.
  static RecordingWriter Continue(std::unique_ptr<mcap::ByteSink> sink, mcap::WrittenPart written, RunId run,
                                  std::int64_t interval_ns, std::uint64_t log_time);

  // Adds the next committed state; its log time is computed here. Errors come from the sink.
  Status Add(const RecordedTick& tick);
  // Makes the ticks so far readable, should the process end.
  Status EndChunk();
  // The chunks survive a loss of power.
  Status Sync() { return writer_.Sync(); }
  Status Close() { return writer_.Close(); }
  // The number of the first tick that is in no whole chunk yet.
  std::uint64_t first_unwritten() const { return first_unwritten_; }

 private:
  RecordingWriter(mcap::Writer writer, RunId run, std::int64_t interval_ns)
      : writer_(std::move(writer)), run_(run), interval_ns_(static_cast<std::uint64_t>(interval_ns)) {}
  void Add(RecordingChannel channel, std::span<const std::byte> data, const RecordedTick& tick);

  mcap::Writer writer_;
  std::array<std::uint16_t, kRecordingChannels> ids_ = {};
  RunId run_;
  std::uint64_t interval_ns_;
  std::uint64_t log_time_ = 0;  // of the newest tick
  std::uint64_t next_number_ = 0;
  std::uint64_t first_unwritten_ = 0;
};

// The bytes of the recording with chunks that are not compressed, up to its first damage. The error is one before the
// first tick.
Result<std::vector<std::byte>> PlainCopy(const Recording& recording);

}  // namespace troupe
