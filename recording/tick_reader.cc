#include "recording/tick_reader.h"

#include <fmt/format.h>

#include <utility>

namespace troupe {

Error TickReader::Broken(const std::string& problem) const {
  return recording_->ErrorIn(next_chunk_ - 1, problem);
}

Result<bool> TickReader::NextChunk() {
  chunk_.reset();
  next_message_ = 0;
  if (next_chunk_ >= recording_->chunks()) return false;
  Result<mcap::Chunk> chunk = recording_->ReadChunk(next_chunk_++);
  if (!chunk.ok()) return chunk.error();
  chunk_ = std::move(chunk).value();
  return true;
}

Result<bool> TickReader::Next(RecordedTick& tick) {
  assembler_.Begin(tick);
  bool begun = false;
  for (;;) {
    if (!chunk_ || next_message_ == chunk_->messages.size()) {
      if (begun) return Broken("found a chunk that ends within a tick");
      Result<bool> more = NextChunk();
      if (!more.ok() || !more.value()) return more;
      continue;
    }
    const mcap::Message& message = chunk_->messages[next_message_++];
    begun = true;
    const std::optional<RecordingChannel> channel = recording_->ChannelOf(message);
    if (!channel) continue;
    const Result<bool> done = assembler_.Add(*channel, message.data, tick);
    if (!done.ok()) return Broken(done.error().message);
    if (!done.value()) continue;
    if (message.log_time < log_time_) {
      return Broken(fmt::format("tick {}: found a log time that decreases", tick.tick));
    }
    tick.log_time = log_time_ = message.log_time;
    return true;
  }
}

}  // namespace troupe
