// Proposal between its message and idl/proposal.idl.
#pragma once

#include "idl/proposal.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

// Valid while the message and the arena live.
troupe_wire_Proposal ToWire(const ProposalMessage& message, WireArena& arena);

// Fills `message` instead of returning one, so that its memory is used again: one arrives from each agent in each tick.
// An error when the sample breaks the contract of idl/proposal.idl; `message` is then unspecified.
Status FromWire(const troupe_wire_Proposal& wire, ProposalMessage& message);

}  // namespace troupe::dds
