// FrameRequest between its message and idl/frame_request.idl.
#pragma once

#include "idl/frame_request.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

troupe_wire_FrameRequest ToWire(const FrameRequest& message, WireArena& arena);
Result<FrameRequest> FromWire(const troupe_wire_FrameRequest& wire);

}  // namespace troupe::dds
