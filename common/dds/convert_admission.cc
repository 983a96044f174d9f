#include "common/dds/convert_admission.h"

namespace troupe::dds {

troupe_wire_Admission ToWire(const AdmissionMessage& message, WireArena& arena) {
  troupe_wire_Admission wire{};
  wire.agent = message.agent;
  wire.run = message.run;
  wire.admitted = message.admitted;
  wire.reason = arena.Copy(message.reason);
  return wire;
}

Status FromWire(const troupe_wire_Admission& wire, AdmissionMessage& message) {
  message.agent = wire.agent;
  message.run = wire.run;
  message.admitted = wire.admitted;
  message.reason = Text(wire.reason);
  return {};
}

}  // namespace troupe::dds
