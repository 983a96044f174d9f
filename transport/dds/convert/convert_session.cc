#include "transport/dds/convert/convert.h"
#include "transport/dds/convert/structs.h"

namespace troupe::dds {

troupe_wire_Session ToWire(const SessionMessage& message, WireArena& arena) {
  return WriteStruct<troupe_wire_Session>(message, arena);
}

Result<SessionMessage> FromWire(const troupe_wire_Session& wire) {
  Result<SessionMessage> message = ReadStruct<SessionMessage>(wire);
  if (message.ok() && !(message.value().lease_seconds >= 0.0)) {
    return Error{{}, "session with a lease that is negative or not a number"};
  }
  return message;
}

troupe_wire_Admissions ToWire(const std::vector<AdmissionMessage>& messages, WireArena& arena) {
  troupe_wire_Admissions wire{};
  troupe_wire_Admission* out = arena.Fill(wire.answers, messages.size());
  for (const AdmissionMessage& message : messages) StructWriter(arena).Write(message, *out++);
  return wire;
}

Result<std::vector<AdmissionMessage>> FromWire(const troupe_wire_Admissions& wire) {
  std::vector<AdmissionMessage> messages;
  for (const troupe_wire_Admission& answer : Elements(wire.answers)) {
    if (Status status = StructReader().Read(answer, messages.emplace_back()); !status.ok()) return status.error();
  }
  return messages;
}

troupe_wire_FrameRequest ToWire(const FrameRequest& message, WireArena& arena) {
  return WriteStruct<troupe_wire_FrameRequest>(message, arena);
}

Result<FrameRequest> FromWire(const troupe_wire_FrameRequest& wire) {
  return ReadStruct<FrameRequest>(wire);
}

troupe_wire_Join ToWire(const JoinMessage& message, WireArena& arena) {
  return WriteStruct<troupe_wire_Join>(message, arena);
}

Result<JoinMessage> FromWire(const troupe_wire_Join& wire) {
  return ReadStruct<JoinMessage>(wire);
}

troupe_wire_Status ToWire(const StatusMessage& message, WireArena& arena) {
  return WriteStruct<troupe_wire_Status>(message, arena);
}

Result<StatusMessage> FromWire(const troupe_wire_Status& wire) {
  return ReadStruct<StatusMessage>(wire);
}

}  // namespace troupe::dds
