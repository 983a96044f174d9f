// Admissions between their messages and idl/admission.idl.
#pragma once

#include <vector>

#include "idl/admission.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

// Valid while the messages and the arena live.
troupe_wire_Admissions ToWire(const std::vector<AdmissionMessage>& messages, WireArena& arena);

// An error when the sample breaks the contract of idl/admission.idl.
Result<std::vector<AdmissionMessage>> FromWire(const troupe_wire_Admissions& wire);

}  // namespace troupe::dds
