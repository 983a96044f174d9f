// Join between its message and idl/join.idl.
#pragma once

#include "idl/join.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

// Valid while the message and the arena live.
troupe_wire_Join ToWire(const JoinMessage& message, WireArena& arena);

// An error when the sample breaks the contract of idl/join.idl.
Result<JoinMessage> FromWire(const troupe_wire_Join& wire);

}  // namespace troupe::dds
