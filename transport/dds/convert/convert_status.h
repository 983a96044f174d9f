// Status between its message and idl/status.idl.
#pragma once

#include "idl/status.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

// Valid while the message and the arena live.
troupe_wire_Status ToWire(const StatusMessage& message, WireArena& arena);

// An error when the sample breaks the contract of idl/status.idl.
Result<StatusMessage> FromWire(const troupe_wire_Status& wire);

}  // namespace troupe::dds
