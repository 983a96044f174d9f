// Messages (transport/protocol/messages.h) as the CDR bytes of their types in idl/, as they travel over DDS: for
// recordings, shared memory and tests. No participant is needed.
//
// Functions without state; any thread may call.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::wire {

// Message: SessionMessage, JoinMessage, std::vector<AdmissionMessage>, FrameMessage (whole), FrameRequest,
// HistoryMessage, ProposalMessage, ControlRequest, ControlReply or StatusMessage.
template <typename Message>
std::vector<std::byte> ToBytes(const Message& message);

// Any bytes are safe. An error when they are not a sample of the message's type, when the sample breaks the contract of
// its IDL file, and when a frame is not whole.
template <typename Message>
Result<Message> FromBytes(std::span<const std::byte> bytes);

}  // namespace troupe::wire
