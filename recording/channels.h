// The channels of a recording: their topics, and the types of their messages.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "recording/mcap/format.h"

namespace troupe {

inline constexpr const char* kRecordingProfile = "troupe";

enum class RecordingChannel : std::uint8_t { kRun, kProposals, kEdits, kKeyframes, kTicks };
inline constexpr std::size_t kRecordingChannels = 5;

struct ChannelType {
  const char* topic;
  const char* type;  // its name in IDL
  const char* file;  // in idl/
};

// In the order of RecordingChannel.
inline constexpr std::array<ChannelType, kRecordingChannels> kChannelTypes = {{
    {"/run", "troupe::wire::RecordedRun", "recorded_run.idl"},
    {"/proposals", "troupe::wire::Proposal", "proposal.idl"},
    {"/edits", "troupe::wire::RecordedEdit", "recorded_edit.idl"},
    {"/keyframes", "troupe::wire::Frame", "frame.idl"},
    {"/ticks", "troupe::wire::RecordedTick", "recorded_tick.idl"},
}};

// The schema of a channel: the text of its IDL file, with all types that it uses.
mcap::Schema SchemaOf(const ChannelType& channel);

}  // namespace troupe
