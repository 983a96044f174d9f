#include "transport/dds/convert/convert_admission.h"

namespace troupe::dds {

troupe_wire_Admissions ToWire(const std::vector<AdmissionMessage>& messages, WireArena& arena) {
  troupe_wire_Admissions wire{};
  troupe_wire_Admission* out = arena.Fill(wire.answers, messages.size());
  for (const AdmissionMessage& message : messages) {
    out->agent = message.agent;
    out->run = message.run;
    out->admitted = message.admitted;
    out->reason = arena.Copy(message.reason);
    out->incarnation = message.incarnation;
    ++out;
  }
  return wire;
}

Result<std::vector<AdmissionMessage>> FromWire(const troupe_wire_Admissions& wire) {
  std::vector<AdmissionMessage> messages;
  for (std::uint32_t i = 0; i < wire.answers._length; ++i) {
    const troupe_wire_Admission& answer = wire.answers._buffer[i];
    messages.push_back({answer.run, answer.agent, answer.admitted, Text(answer.reason), answer.incarnation});
  }
  return messages;
}

}  // namespace troupe::dds
