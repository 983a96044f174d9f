#include <utility>

#include "transport/dds/convert/convert.h"
#include "transport/dds/convert/structs.h"

namespace troupe::dds {

troupe_wire_Session ToWire(const SessionMessage& message, WireArena& arena) {
  troupe_wire_Session wire{};
  wire.run = message.run;
  wire.protocol_version = message.protocol_version;
  wire.host = arena.Copy(message.host);
  wire.pid = message.pid;
  wire.lease = message.lease_seconds;
  wire.begun = message.begun;
  wire.world = ToWire(*message.world, arena);
  wire.world_edition = message.world_edition;
  wire.incarnation = message.incarnation;
  return wire;
}

Result<SessionMessage> FromWire(const troupe_wire_Session& wire) {
  SessionMessage message;
  message.run = wire.run;
  message.protocol_version = wire.protocol_version;
  message.host = Text(wire.host);
  message.pid = wire.pid;
  message.lease_seconds = wire.lease;
  message.begun = wire.begun;
  message.world_edition = wire.world_edition;
  message.incarnation = wire.incarnation;
  if (!(wire.lease >= 0.0)) return Error{{}, "session with a lease that is negative or not a number"};
  Result<WorldDescription> world = FromWire(wire.world);
  if (!world.ok()) return world.error();
  message.world = std::move(world.value());
  return message;
}

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

troupe_wire_Join ToWire(const JoinMessage& message, WireArena& arena) {
  troupe_wire_Join wire{};
  wire.agent = message.agent;
  wire.run = message.run;
  wire.protocol_version = message.protocol_version;
  wire.world_hash = message.world_hash;
  wire.host = arena.Copy(message.host);
  wire.pid = message.pid;
  arena.FillStrings(wire.robots, message.robots);
  arena.FillStrings(wire.accept_goals, message.accept_goals);
  wire.world_edition = message.world_edition;
  wire.incarnation = message.incarnation;
  wire.remembers = message.memory.has_value();
  if (message.memory) {
    wire.memory_edition = message.memory->edition;
    wire.memory_tick = message.memory->tick;
    wire.memory_decided = message.memory->decided;
  }
  return wire;
}

Result<JoinMessage> FromWire(const troupe_wire_Join& wire) {
  JoinMessage message;
  message.agent = wire.agent;
  message.run = wire.run;
  message.protocol_version = wire.protocol_version;
  message.world_hash = wire.world_hash;
  message.host = Text(wire.host);
  message.pid = wire.pid;
  message.robots = Strings(wire.robots);
  message.accept_goals = Strings(wire.accept_goals);
  message.world_edition = wire.world_edition;
  message.incarnation = wire.incarnation;
  if (wire.remembers) message.memory = {wire.memory_edition, wire.memory_tick, wire.memory_decided};
  return message;
}

troupe_wire_Status ToWire(const StatusMessage& message, WireArena& arena) {
  troupe_wire_Status wire{};
  StructWriter(arena).Write(message, wire);
  return wire;
}

Result<StatusMessage> FromWire(const troupe_wire_Status& wire) {
  StatusMessage message;
  if (Status status = StructReader().Read(wire, message); !status.ok()) return status.error();
  return message;
}

}  // namespace troupe::dds
