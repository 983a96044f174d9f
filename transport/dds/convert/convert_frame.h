// Frame between its message and idl/frame.idl.
#pragma once

#include "idl/frame.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

// Valid while the message and the arena live. With `before`, the state of the tick before, the frame has only the
// changes since. REQUIRES: `before` is null or has as many robots, joints, grippers and objects.
troupe_wire_Frame ToWire(const FrameMessage& message, const WorldState* before, WireArena& arena);
troupe_wire_Frame ToWire(const FrameMessage& message, WireArena& arena);  // a whole one

// False if the frame has the changes since a frame that is not `message`.
bool CanRead(const troupe_wire_Frame& wire, const FrameMessage& message);
// Brings `message`, the last frame, up to this one. An error when the sample breaks the contract of idl/frame.idl;
// `message` is then empty. REQUIRES: CanRead(wire, message)
Status FromWire(const troupe_wire_Frame& wire, FrameMessage& message);

}  // namespace troupe::dds
