// Session between its message and idl/session.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/protocol/messages.h"
#include "idl/session.h"

namespace troupe::dds {

// Good while the message and the arena live.
troupe_wire_Session ToWire(const SessionMessage& message, WireArena& arena);

// An error when the peer sent what breaks the contract of idl/session.idl; `message` is then of no use.
Status FromWire(const troupe_wire_Session& wire, SessionMessage& message);

}  // namespace troupe::dds
