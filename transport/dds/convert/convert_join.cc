#include "transport/dds/convert/convert_join.h"

namespace troupe::dds {

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

}  // namespace troupe::dds
