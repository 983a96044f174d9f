#include "transport/dds/convert/convert_status.h"

namespace troupe::dds {

troupe_wire_Status ToWire(const StatusMessage& message, WireArena& arena) {
  troupe_wire_Status wire{};
  wire.run = message.run;
  wire.tick = message.tick;
  wire.target = message.target_ticks;
  wire.sim_time = message.sim_seconds;
  wire.wall_time = message.wall_seconds;
  wire.real_time_factor = message.real_time_factor;
  wire.robots = message.robots;
  wire.agents = message.agents;
  arena.FillStrings(wire.waiting_for, message.waiting_for);
  wire.waiting_time = message.waiting_seconds;
  wire.edition = message.edition;
  wire.incarnation = message.incarnation;
  wire.speed = message.speed.value_or(0.0);
  wire.phase_wait_time = message.phases.wait;
  wire.phase_step_time = message.phases.step;
  wire.phase_record_time = message.phases.record;
  wire.phase_publish_time = message.phases.publish;
  return wire;
}

Result<StatusMessage> FromWire(const troupe_wire_Status& wire) {
  StatusMessage message;
  message.run = wire.run;
  message.tick = wire.tick;
  message.target_ticks = wire.target;
  message.sim_seconds = wire.sim_time;
  message.wall_seconds = wire.wall_time;
  message.real_time_factor = wire.real_time_factor;
  message.robots = wire.robots;
  message.agents = wire.agents;
  message.waiting_for = Strings(wire.waiting_for);
  message.waiting_seconds = wire.waiting_time;
  message.edition = wire.edition;
  message.incarnation = wire.incarnation;
  if (wire.speed > 0.0) message.speed = wire.speed;
  message.phases = {wire.phase_wait_time, wire.phase_step_time, wire.phase_record_time, wire.phase_publish_time};
  return message;
}

}  // namespace troupe::dds
