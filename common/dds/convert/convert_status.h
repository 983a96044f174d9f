// Status between its message and idl/status.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/binding/wire.h"
#include "common/protocol/messages.h"
#include "idl/status.h"

namespace troupe::dds {

// Valid while the message and the arena live.
troupe_wire_Status ToWire(const StatusMessage& message, WireArena& arena);

// An error when the sample breaks the contract of idl/status.idl.
Result<StatusMessage> FromWire(const troupe_wire_Status& wire);

}  // namespace troupe::dds
