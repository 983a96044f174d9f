// Join between its message and idl/join.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/protocol/messages.h"
#include "idl/join.h"

namespace troupe::dds {

// Good while the message and the arena live.
troupe_wire_Join ToWire(const JoinMessage& message, WireArena& arena);

// An error when the peer sent what breaks the contract of idl/join.idl; `message` is then of no use.
Status FromWire(const troupe_wire_Join& wire, JoinMessage& message);

}  // namespace troupe::dds
