// Status between its message and idl/status.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/protocol/messages.h"
#include "idl/status.h"

namespace troupe::dds {

// Good while the message and the arena live.
troupe_wire_Status ToWire(const StatusMessage& message, WireArena& arena);

// An error when the peer sent what breaks the contract of idl/status.idl; `message` is then of no use.
Status FromWire(const troupe_wire_Status& wire, StatusMessage& message);

}  // namespace troupe::dds
