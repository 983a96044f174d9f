// Proposal between its message and idl/proposal.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/protocol/messages.h"
#include "idl/proposal.h"

namespace troupe::dds {

// Good while the message and the arena live.
troupe_wire_Proposal ToWire(const ProposalMessage& message, WireArena& arena);

// An error when the peer sent what breaks the contract of idl/proposal.idl; `message` is then of no use.
Status FromWire(const troupe_wire_Proposal& wire, ProposalMessage& message);

}  // namespace troupe::dds
