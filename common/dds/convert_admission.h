// Admission between its message and idl/admission.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/protocol/messages.h"
#include "idl/admission.h"

namespace troupe::dds {

// Good while the message and the arena live.
troupe_wire_Admission ToWire(const AdmissionMessage& message, WireArena& arena);

// An error when the peer sent what breaks the contract of idl/admission.idl; `message` is then of no use.
Status FromWire(const troupe_wire_Admission& wire, AdmissionMessage& message);

}  // namespace troupe::dds
