#include "transport/dds/convert/convert_parts.h"

namespace troupe::dds {

troupe_wire_World ToWire(const WorldDescription& world, WireArena& arena) {
  troupe_wire_World wire{};
  wire.name = arena.Copy(world.name);
  wire.seed = world.seed;
  wire.interval = world.interval_ns;
  PartsToWire(world.shapes, wire.shapes, arena);
  PartsToWire(world.models, wire.models, arena);
  PartsToWire(world.robots, wire.robots, arena);
  PartsToWire(world.joints, wire.joints, arena);
  PartsToWire(world.grippers, wire.grippers, arena);
  std::uint32_t* objects = arena.Fill(wire.objects, world.objects.size());
  for (ModelId object : world.objects) *objects++ = static_cast<std::uint32_t>(object.index());
  wire.gravity = world.gravity;
  PartsToWire(world.places, wire.places, arena);
  PartsToWire(world.doors, wire.doors, arena);
  PartsToWire(world.lifts, wire.lifts, arena);
  PartsToWire(world.goal_sets, wire.goal_sets, arena);
  PartsToWire(world.people, wire.people, arena);
  PartsToWire(world.levels, wire.levels, arena);
  PartsToWire(world.lane_graphs, wire.lane_graphs, arena);
  return wire;
}

Result<WorldDescription> FromWire(const troupe_wire_World& wire) {
  WorldDescription world;
  world.name = Text(wire.name);
  world.seed = wire.seed;
  world.interval_ns = wire.interval;
  Status status;
  const auto read = [&](const auto& from, auto& to) {
    if (status.ok()) status = PartsFromWire(from, to);
  };
  read(wire.shapes, world.shapes);
  read(wire.models, world.models);
  read(wire.robots, world.robots);
  read(wire.joints, world.joints);
  read(wire.grippers, world.grippers);
  for (std::uint32_t object : Elements(wire.objects)) world.objects.emplace_back(object);
  world.gravity = wire.gravity;
  read(wire.places, world.places);
  read(wire.doors, world.doors);
  read(wire.lifts, world.lifts);
  read(wire.goal_sets, world.goal_sets);
  read(wire.people, world.people);
  read(wire.levels, world.levels);
  read(wire.lane_graphs, world.lane_graphs);
  if (status.ok()) status = Validate(world);
  if (!status.ok()) return status.error();
  return world;
}

}  // namespace troupe::dds
