#include "common/dds/convert_control.h"

namespace troupe::dds {

troupe_wire_Control ToWire(const ControlRequest& message, WireArena&) {
  return {message.client, message.number, static_cast<std::uint8_t>(message.command), message.ticks};
}

troupe_wire_ControlReply ToWire(const ControlReply& message, WireArena& arena) {
  troupe_wire_ControlReply wire{};
  wire.client = message.client;
  wire.number = message.number;
  wire.done = message.done;
  wire.problem = arena.Copy(message.problem);
  wire.state = static_cast<std::uint8_t>(message.state);
  wire.tick = message.tick;
  wire.state_hash = message.state_hash;
  return wire;
}

Status FromWire(const troupe_wire_Control& wire, ControlRequest& message) {
  if (wire.command > static_cast<std::uint8_t>(ControlCommand::kStep)) {
    return Error{{}, "control request with command " + std::to_string(wire.command) + ", expected 0 to 3"};
  }
  message = {wire.client, wire.number, static_cast<ControlCommand>(wire.command), wire.ticks};
  return {};
}

Status FromWire(const troupe_wire_ControlReply& wire, ControlReply& message) {
  if (wire.state > static_cast<std::uint8_t>(RunState::kOver)) {
    return Error{{}, "control reply with state " + std::to_string(wire.state) + ", expected 0 to 3"};
  }
  message.client = wire.client;
  message.number = wire.number;
  message.done = wire.done;
  message.problem = Text(wire.problem);
  message.state = static_cast<RunState>(wire.state);
  message.tick = wire.tick;
  message.state_hash = wire.state_hash;
  return {};
}

}  // namespace troupe::dds
