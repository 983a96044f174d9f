// History between its message and idl/history.idl.
#pragma once

#include "idl/history.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

// Valid while the message and the arena live. A frame is written as the changes since the entry before where it can be.
troupe_wire_History ToWire(const HistoryMessage& message, WireArena& arena);

// An error when the sample breaks the contract of idl/history.idl.
Result<HistoryMessage> FromWire(const troupe_wire_History& wire);

}  // namespace troupe::dds
