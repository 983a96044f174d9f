#include "transport/dds/convert/convert_session.h"

#include <utility>

#include "transport/dds/convert/convert_world.h"

namespace troupe::dds {

troupe_wire_Session ToWire(const SessionMessage& message, WireArena& arena) {
  troupe_wire_Session wire{};
  wire.run = message.run;
  wire.protocol_version = message.protocol_version;
  wire.host = arena.Copy(message.host);
  wire.pid = message.pid;
  wire.lease = message.lease_seconds;
  wire.begun = message.begun;
  wire.world = ToWire(message.world, arena);
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

}  // namespace troupe::dds
