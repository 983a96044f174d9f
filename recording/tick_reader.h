// TickReader: the ticks of a recording, one after another.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "recording/recording.h"
#include "recording/tick_messages.h"
#include "troupe/result.h"

namespace troupe {

class TickReader {
 public:
  // Begins at a chunk. The recording outlives the reader.
  explicit TickReader(const Recording& recording, std::size_t chunk = 0)
      : recording_(&recording),
        next_chunk_(chunk),
        assembler_(chunk == 0 ? std::optional<std::uint64_t>(0) : std::nullopt) {}

  // Reads the next tick; false at the end of the readable ticks. The error is damage: of a chunk, or a missing tick.
  // `tick`: valid after true; its memory is reused.
  Result<bool> Next(RecordedTick& tick);

 private:
  Result<bool> NextChunk();
  Error Broken(const std::string& problem) const;

  const Recording* recording_;
  std::size_t next_chunk_;
  std::optional<mcap::Chunk> chunk_;
  std::size_t next_message_ = 0;
  TickAssembler assembler_;
  std::uint64_t log_time_ = 0;  // of the last tick
};

}  // namespace troupe
