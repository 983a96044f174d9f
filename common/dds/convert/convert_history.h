// History between its message and idl/history.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/binding/wire.h"
#include "common/protocol/messages.h"
#include "idl/history.h"

namespace troupe::dds {

// Valid while the message and the arena live. A frame is written as the changes since the entry before where it can be.
troupe_wire_History ToWire(const HistoryMessage& message, WireArena& arena);

// An error when the sample breaks the contract of idl/history.idl.
Result<HistoryMessage> FromWire(const troupe_wire_History& wire);

}  // namespace troupe::dds
