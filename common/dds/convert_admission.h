// Admissions between their messages and idl/admission.idl.
#pragma once

#include <vector>

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/protocol/messages.h"
#include "idl/admission.h"

namespace troupe::dds {

// Good while the messages and the arena live.
troupe_wire_Admissions ToWire(const std::vector<AdmissionMessage>& messages, WireArena& arena);

// An error when the peer sent what breaks the contract of idl/admission.idl; `messages` is then of no use.
Status FromWire(const troupe_wire_Admissions& wire, std::vector<AdmissionMessage>& messages);

}  // namespace troupe::dds
