// Frame between its message and idl/frame.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/protocol/messages.h"
#include "idl/frame.h"

namespace troupe::dds {

// Good while the message and the arena live.
troupe_wire_Frame ToWire(const FrameMessage& message, WireArena& arena);

// An error when the peer sent what breaks the contract of idl/frame.idl; `message` is then of no use.
Status FromWire(const troupe_wire_Frame& wire, FrameMessage& message);

}  // namespace troupe::dds
