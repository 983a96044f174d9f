#include "common/recording/tick_reader.h"

#include <fmt/format.h>

#include <utility>

#include "common/recording/convert_recorded.h"
#include "common/wire/message_bytes.h"

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
  tick.edit.reset();
  tick.keyframe.reset();
  tick.proposals.clear();
  has_proposals_ = false;
  bool begun = false;
  for (;;) {
    if (!chunk_ || next_message_ == chunk_->messages.size()) {
      if (begun) return Broken("found a chunk that ends within a tick");
      Result<bool> more = NextChunk();
      if (!more.ok() || !more.value()) return more;
      continue;
    }
    const Result<bool> done = Read(chunk_->messages[next_message_++], tick);
    if (!done.ok()) return Broken(done.error().message);
    begun = true;
    if (!done.value()) continue;
    if (Status broken = Check(tick); !broken.ok()) return Broken(broken.error().message);
    expected_ = tick.number + 1;
    log_time_ = tick.log_time;
    return true;
  }
}

Result<bool> TickReader::Read(const mcap::Message& message, RecordedTick& tick) {
  const std::optional<RecordingChannel> channel = recording_->ChannelOf(message);
  if (!channel) return false;
  switch (*channel) {
    case RecordingChannel::kRun:
      return Error{{}, "found a second begin of the run"};
    case RecordingChannel::kProposals: {
      if (Status broken = ReadProposals(message, tick); !broken.ok()) return broken.error();
      return false;
    }
    case RecordingChannel::kEdits: {
      Result<RecordedEdit> edit = EditFromBytes(message.data);
      if (!edit.ok()) return edit.error();
      if (tick.edit) return Error{{}, "found two edits of one tick"};
      tick.edit = std::move(edit).value();
      return false;
    }
    case RecordingChannel::kKeyframes: {
      Result<FrameMessage> keyframe = wire::FromBytes<FrameMessage>(message.data);
      if (!keyframe.ok()) return keyframe.error();
      if (tick.keyframe) return Error{{}, "found two keyframes of one tick"};
      tick.keyframe = std::move(keyframe).value();
      return false;
    }
    case RecordingChannel::kTicks:
      break;
  }
  if (Status broken = TickFromBytes(message.data, tick); !broken.ok()) return broken.error();
  tick.log_time = message.log_time;
  return true;
}

Status TickReader::ReadProposals(const mcap::Message& message, RecordedTick& tick) {
  Result<ProposalMessage> proposals = wire::FromBytes<ProposalMessage>(message.data);
  if (!proposals.ok()) return proposals.error();
  if (has_proposals_) return Error{{}, "found the proposals of one tick twice"};
  has_proposals_ = true;
  proposals_ = std::move(proposals).value();
  tick.proposals = std::move(proposals_.proposals);
  return {};
}

Status TickReader::Check(const RecordedTick& tick) const {
  const auto broken = [&](const std::string& problem) {
    return Error{{}, fmt::format("tick {}: {}", tick.tick, problem)};
  };
  if (expected_ && tick.number != *expected_) {
    return broken(fmt::format("found state number {}, expected {}: states are missing", tick.number, *expected_));
  }
  if (expected_ && tick.log_time < log_time_) return broken("found a log time that decreases");
  if (tick.is_step() != has_proposals_) {
    return broken(has_proposals_ ? "found proposals, expected none" : "found neither proposals nor an edit");
  }
  if (tick.number == 0 && tick.edit) return broken("found an edit before the first state");
  if (has_proposals_ && (proposals_.tick != tick.tick || proposals_.edition != tick.edition)) {
    return broken(fmt::format("found proposals of tick {}", proposals_.tick));
  }
  if (tick.keyframe && (tick.keyframe->state.tick != tick.tick || tick.keyframe->edition != tick.edition ||
                        tick.keyframe->state_hash != tick.state_hash)) {
    return broken(fmt::format("found a keyframe of tick {}", tick.keyframe->state.tick));
  }
  return {};
}

}  // namespace troupe
