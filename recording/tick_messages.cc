#include "recording/tick_messages.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "recording/convert_recorded.h"
#include "transport/wire/message_bytes.h"

namespace troupe {

std::vector<TickMessage> MessagesOf(const RecordedTick& tick, RunId run) {
  std::vector<TickMessage> messages;
  if (tick.is_step()) {
    ProposalMessage message;
    message.run = run;
    message.tick = tick.tick;
    message.edition = tick.edition;
    message.proposals = tick.proposals;
    messages.push_back({RecordingChannel::kProposals, wire::ToBytes(message)});
  }
  if (tick.edit) messages.push_back({RecordingChannel::kEdits, EditToBytes(*tick.edit)});
  if (tick.keyframe) messages.push_back({RecordingChannel::kKeyframes, wire::ToBytes(*tick.keyframe)});
  messages.push_back({RecordingChannel::kTicks, TickToBytes(tick)});
  return messages;
}

void TickAssembler::Begin(RecordedTick& tick) {
  tick.edit.reset();
  tick.keyframe.reset();
  tick.proposals.clear();
  has_proposals_ = false;
}

Result<bool> TickAssembler::Add(RecordingChannel channel, std::span<const std::byte> data, RecordedTick& tick) {
  switch (channel) {
    case RecordingChannel::kRun:
      return Error{{}, "found a second begin of the run"};
    case RecordingChannel::kProposals: {
      if (Status broken = AddProposals(data, tick); !broken.ok()) return broken.error();
      return false;
    }
    case RecordingChannel::kEdits: {
      Result<RecordedEdit> edit = EditFromBytes(data);
      if (!edit.ok()) return edit.error();
      if (tick.edit) return Error{{}, "found two edits of one tick"};
      tick.edit = std::move(edit).value();
      return false;
    }
    case RecordingChannel::kKeyframes: {
      Result<FrameMessage> keyframe = wire::FromBytes<FrameMessage>(data);
      if (!keyframe.ok()) return keyframe.error();
      if (tick.keyframe) return Error{{}, "found two keyframes of one tick"};
      tick.keyframe = std::move(keyframe).value();
      return false;
    }
    case RecordingChannel::kTicks:
      break;
  }
  if (Status broken = TickFromBytes(data, tick); !broken.ok()) return broken.error();
  if (Status broken = Check(tick); !broken.ok()) return broken.error();
  expected_ = tick.number + 1;
  return true;
}

Status TickAssembler::AddProposals(std::span<const std::byte> data, RecordedTick& tick) {
  Result<ProposalMessage> proposals = wire::FromBytes<ProposalMessage>(data);
  if (!proposals.ok()) return proposals.error();
  if (has_proposals_) return Error{{}, "found the proposals of one tick twice"};
  has_proposals_ = true;
  proposals_ = std::move(proposals).value();
  tick.proposals = std::move(proposals_.proposals);
  return {};
}

Status TickAssembler::Check(const RecordedTick& tick) const {
  const auto broken = [&](const std::string& problem) {
    return Error{{}, fmt::format("tick {}: {}", tick.tick, problem)};
  };
  if (expected_ && tick.number != *expected_) {
    return broken(fmt::format("found state number {}, expected {}: states are missing", tick.number, *expected_));
  }
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
