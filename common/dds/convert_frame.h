// Frame between its message and idl/frame.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/protocol/messages.h"
#include "idl/frame.h"

namespace troupe::dds {

// Good while the message and the arena live. With `before`, the state of the tick before, a frame of what has changed
// since. REQUIRES: `before` is null or has as many robots, joints, grippers and objects.
troupe_wire_Frame ToWire(const FrameMessage& message, const WorldState* before, WireArena& arena);
troupe_wire_Frame ToWire(const FrameMessage& message, WireArena& arena);  // a whole one

// False if the frame says what has changed since another frame than `message`.
bool CanTake(const troupe_wire_Frame& wire, const FrameMessage& message);
// Brings `message`, the last frame, up to this one. An error when the peer sent what breaks the contract of
// idl/frame.idl; `message` is then empty. REQUIRES: CanTake(wire, message)
Status FromWire(const troupe_wire_Frame& wire, FrameMessage& message);

}  // namespace troupe::dds
