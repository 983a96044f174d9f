// Session between its message and idl/session.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/binding/wire.h"
#include "common/protocol/messages.h"
#include "idl/session.h"

namespace troupe::dds {

// Valid while the message and the arena live.
troupe_wire_Session ToWire(const SessionMessage& message, WireArena& arena);

// An error when the sample breaks the contract of idl/session.idl.
Result<SessionMessage> FromWire(const troupe_wire_Session& wire);

}  // namespace troupe::dds
