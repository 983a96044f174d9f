// Session between its message and idl/session.idl.
#pragma once

#include "idl/session.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

// Valid while the message and the arena live.
troupe_wire_Session ToWire(const SessionMessage& message, WireArena& arena);

// An error when the sample breaks the contract of idl/session.idl.
Result<SessionMessage> FromWire(const troupe_wire_Session& wire);

}  // namespace troupe::dds
