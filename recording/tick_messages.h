// The messages of one tick of a recorded run: their order, and the tick that they make.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "recording/channels.h"
#include "recording/recorded_run.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe {

struct TickMessage {
  RecordingChannel channel = RecordingChannel::kTicks;
  std::vector<std::byte> data;  // CDR
};

// In the order in which a recording has them: the last is that of kTicks.
std::vector<TickMessage> MessagesOf(const RecordedTick& tick, RunId run);

// Makes ticks of messages that follow each other, and checks that none is missing.
class TickAssembler {
 public:
  // Of the first tick; nothing: any.
  explicit TickAssembler(std::optional<std::uint64_t> first_number) : expected_(first_number) {}

  // Clears the tick, whose memory is reused, for the next messages.
  void Begin(RecordedTick& tick);
  // True if the message was the last of the tick, which then lacks its log time.
  Result<bool> Add(RecordingChannel channel, std::span<const std::byte> data, RecordedTick& tick);
  // The number of the tick that follows; nothing: any.
  const std::optional<std::uint64_t>& expected() const { return expected_; }

 private:
  Status AddProposals(std::span<const std::byte> data, RecordedTick& tick);
  Status Check(const RecordedTick& tick) const;

  std::optional<std::uint64_t> expected_;
  bool has_proposals_ = false;
  ProposalMessage proposals_;
};

}  // namespace troupe
