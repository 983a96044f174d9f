// FrameRequest between its message and idl/frame_request.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/binding/wire.h"
#include "common/protocol/messages.h"
#include "idl/frame_request.h"

namespace troupe::dds {

troupe_wire_FrameRequest ToWire(const FrameRequest& message, WireArena& arena);
Result<FrameRequest> FromWire(const troupe_wire_FrameRequest& wire);

}  // namespace troupe::dds
