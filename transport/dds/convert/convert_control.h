// Control requests and replies between their messages and idl/control.idl.
#pragma once

#include "idl/control.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

// Valid while the message and the arena live.
troupe_wire_Control ToWire(const ControlRequest& message, WireArena& arena);
troupe_wire_ControlReply ToWire(const ControlReply& message, WireArena& arena);

// An error when the sample breaks the contract of idl/control.idl.
Result<ControlRequest> FromWire(const troupe_wire_Control& wire);
Result<ControlReply> FromWire(const troupe_wire_ControlReply& wire);

}  // namespace troupe::dds
