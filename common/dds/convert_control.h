// Control requests and their answers between their messages and idl/control.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/protocol/messages.h"
#include "idl/control.h"

namespace troupe::dds {

// Good while the message and the arena live.
troupe_wire_Control ToWire(const ControlRequest& message, WireArena& arena);
troupe_wire_ControlReply ToWire(const ControlReply& message, WireArena& arena);

// An error when the peer sent what breaks the contract of idl/control.idl; `message` is then of no use.
Status FromWire(const troupe_wire_Control& wire, ControlRequest& message);
Status FromWire(const troupe_wire_ControlReply& wire, ControlReply& message);

}  // namespace troupe::dds
